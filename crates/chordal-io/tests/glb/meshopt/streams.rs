//! Streams decode to what was encoded, bit for bit.
use super::{PackedRows, encode, known_streams};
use chordal_testkit::Random;

#[track_caller]
fn expect(packed: &PackedRows, source: &[u8]) {
    let found = packed.unpacked().unwrap_or_else(|error| panic!("{error} ({})", error.code));
    let first = found.iter().zip(source).position(|(a, b)| a != b);
    assert_eq!((first, found.len()), (None, source.len()), "{} {}", packed.mode, packed.stride);
}

/// Rows that are smooth in some bytes and wild in others.
fn rows(n: usize, stride: usize, random: &mut Random) -> Vec<u8> {
    let slopes: Vec<usize> = (0..stride).map(|_| random.below(4) * random.below(6)).collect();
    let wild = random.below(8);
    (0..n * stride)
        .map(|at| {
            let (i, k) = (at / stride, at % stride);
            let noise = if k % 8 == wild { random.below(256) } else { random.below(2) };
            (i * slopes[k] / 3 + noise * usize::from(slopes[k] > 0)) as u8
        })
        .collect()
}

#[test]
fn vertices_of_any_stride_and_count() {
    for version in [0, 1] {
        let mut random = Random::new(41 + u64::from(version));
        for stride in [4, 8, 12, 16, 32, 36, 60, 64, 128, 252, 256] {
            let most = 8192 / stride / 16 * 16;
            for n in [1, 2, 15, 16, 17, 63, 64, 65, most.min(256), most.min(256) + 1, 300] {
                let source = rows(n, stride, &mut random);
                let packed = encode::vertices(&source, stride, version, &mut random);
                assert_eq!(packed.stream[0], 0xA0 | version);
                expect(&packed, &source);
            }
        }
    }
}

fn bytes_of(list: &[u32], stride: usize) -> Vec<u8> {
    list.iter().flat_map(|i| i.to_le_bytes()[..stride].to_vec()).collect()
}

/// The triangles of a grid, in order or shuffled, with some at random between them.
fn mesh(random: &mut Random, most: usize) -> Vec<[u32; 3]> {
    let (wide, high) = (2 + random.below(9) as u32, 2 + random.below(9) as u32);
    let mut list = Vec::new();
    for y in 0..high {
        for x in 0..wide {
            let at = |dx: u32, dy: u32| (y + dy) * (wide + 1) + x + dx;
            list.extend([[at(0, 0), at(1, 0), at(0, 1)], [at(0, 1), at(1, 0), at(1, 1)]]);
        }
    }
    for _ in 0..random.below(20) {
        let (i, j) = (random.below(list.len()), random.below(list.len()));
        list.swap(i, j);
        list[j] = [0; 3].map(|_| random.below(most) as u32);
    }
    // A second mesh, from zero again.
    list.extend([[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]);
    list.truncate(list.len() / 2 * 2);
    if random.below(3) > 0 {
        // Numbers by first use, as encoders want them.
        let mut known: Vec<u32> = Vec::new();
        for v in list.iter_mut().flatten() {
            let place = known.iter().position(|k| k == v).unwrap_or(known.len());
            if place == known.len() {
                known.push(*v);
            }
            *v = place as u32;
        }
    }
    list
}

#[test]
fn triangles_up_to_their_first_corner() {
    let mut seen = [0_usize; 256];
    for version in [0, 1] {
        let mut random = Random::new(90 + u64::from(version));
        for round in 0..300 {
            let (stride, most) = [(2, 65_535), (4, u32::MAX as usize)][round % 2];
            let list = mesh(&mut random, most);
            let (packed, turned) = encode::triangles(&list, stride, version, &mut random);
            expect(&packed, &bytes_of(&turned, stride));
            // What comes out are the triangles that went in.
            for (three, triangle) in turned.chunks(3).zip(&list) {
                assert!((0..3).any(|k| (0..3).all(|i| three[i] == triangle[(i + k) % 3])));
            }
            packed.stream[1..=list.len()].iter().for_each(|code| seen[usize::from(*code)] += 1);
        }
    }
    let on_edges = (0..0xF0).filter(|code| seen[*code] > 0).count();
    assert!(on_edges > 120, "only {on_edges} codes of triangles on edges");
    assert!((0xF0..=0xFF).filter(|code| seen[*code] > 0).count() > 8, "{:?}", &seen[0xF0..]);
}

#[test]
fn every_place_of_the_table_of_codes() {
    // The first triangle is new; each other has a new corner, the newest one before and the one before that.
    let codes: Vec<u8> = (0xF0..=0xFD).collect();
    let mut table = [0x12; 16];
    (table[0], table[14], table[15]) = (0, 0, 0);
    let stream = [&[0xE1][..], &codes, &table].concat();
    let mut expected = vec![0, 1, 2];
    (1..14).for_each(|i| expected.extend([i + 2, i + 1, i]));
    expect(&PackedRows::new("TRIANGLES", 4, 42, stream), &bytes_of(&expected, 4));
}

#[test]
fn indices_of_no_triangles() {
    let mut random = Random::new(7);
    for version in [0, 1] {
        for n in [2, 4, 100, 1000] {
            let near: Vec<u32> = (0..n).map(|i| i * 3 / 2 + random.below(3) as u32).collect();
            let far: Vec<u32> = (0..n).map(|_| random.below(1 << 29) as u32).collect();
            expect(&encode::sequence(&near, 2, version, &mut random), &bytes_of(&near, 2));
            expect(&encode::sequence(&near, 4, version, &mut random), &bytes_of(&near, 4));
            expect(&encode::sequence(&far, 4, version, &mut random), &bytes_of(&far, 4));
        }
    }
    // The largest difference in both directions.
    let list = [(1 << 30) - 1, 0, (1 << 30) - 1, u32::MAX - (1 << 30) + 1, u32::MAX, 0];
    let mut stream = vec![0xD1];
    // Zigzag of each difference, above the bit that names the baseline: the first or, for the last three, the
    // second one.
    stream.extend([0xFC, 0xFF, 0xFF, 0xFF, 0x0F]);
    stream.extend([0xFA, 0xFF, 0xFF, 0xFF, 0x0F]);
    stream.extend([0xFC, 0xFF, 0xFF, 0xFF, 0x0F]);
    stream.extend([0xFF, 0xFF, 0xFF, 0xFF, 0x0F]);
    stream.extend([0xFD, 0xFF, 0xFF, 0xFF, 0x0F]);
    stream.extend([0x05]);
    stream.extend([0; 4]);
    expect(&PackedRows::new("INDICES", 4, 6, stream), &bytes_of(&list, 4));
}

#[test]
fn streams_of_the_original_library() {
    let all = known_streams();
    for (mode, filter, least) in [("ATTRIBUTES", "NONE", 9), ("TRIANGLES", "NONE", 3), ("INDICES", "NONE", 2)]
    {
        let mut n = 0;
        for known in all.iter().filter(|known| known.packed.mode == mode && known.packed.filter == filter) {
            // The decoder of three.js says the same of these bytes, in `tests/web/meshopt.mjs`.
            expect(&known.packed, &known.decoded);
            n += 1;
        }
        assert!(n >= least, "{n} streams of {mode}");
    }
    let first = |name: &str| all.iter().find(|known| known.name == name).expect("there").packed.stream[0];
    assert_eq!((first("wild v0"), first("wild v1")), (0xA0, 0xA1));
    let jumps = all.iter().find(|known| known.name == "jumps").expect("there");
    assert_eq!(jumps.packed.stream.last(), Some(&0x12), "its channel is of the third mode, rotated by 1");
}

#[test]
fn the_example_of_the_specification() {
    // Sixteen differences of four bits, two of which are whole bytes; the other bytes of a row are still.
    let mut stream = vec![0xA0, 2];
    stream.extend([0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5]);
    stream.extend([0, 0, 0]);
    stream.extend([0; 32]);
    let deltas = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0_i8];
    let mut last = 0_u8;
    let source: Vec<u8> = deltas
        .iter()
        .flat_map(|delta| {
            last = last.wrapping_add(*delta as u8);
            [last, 0, 0, 0]
        })
        .collect();
    expect(&PackedRows::new("ATTRIBUTES", 4, 16, stream), &source);
}
