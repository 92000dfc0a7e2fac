//! Mutations of small files, and large hostile ones: no panic, no hang, no more memory than promised.
// Long because the hostile files stand beside the allocator that measures them.
mod common;
#[path = "sweep/corpora.rs"]
mod corpora;
#[path = "volumes/dicom_build.rs"]
#[allow(dead_code)]
mod dicom_build;
#[path = "sweep/memory.rs"]
mod memory;
#[path = "sweep/seeds.rs"]
mod seeds;
#[path = "threemf/build.rs"]
#[allow(dead_code)]
mod threemf_build;
#[path = "usd/build.rs"]
#[allow(dead_code)]
mod usd_build;

use chordal::explicit::{Curve, CurveSegment};
use chordal_io::{Content, Format, Limits, ReadError, ReadOutcome, read};
use chordal_testkit::Random;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts what this thread holds and held at most.
struct Counting;

thread_local! {
    static HELD: Cell<(isize, isize)> = const { Cell::new((0, 0)) };
}

fn count(change: isize) {
    // A thread that is ending has no counter any more.
    let _ = HELD.try_with(|cell| {
        let (held, most) = cell.get();
        cell.set((held + change, most.max(held + change)));
    });
}

// SAFETY: every call is passed on to the system's allocator unchanged; counting touches no memory of its
// blocks.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Reads and returns the most that was held on the way, in bytes.
fn measured(bytes: &[u8], format: Format) -> (Result<ReadOutcome, ReadError>, u64) {
    held_by(|| read(bytes, format, &Limits::default()))
}

fn held_by<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = HELD.with(|cell| {
        let (held, _) = cell.get();
        cell.set((held, held));
        held
    });
    let result = work();
    let (_, most) = HELD.with(Cell::get);
    (result, (most - before) as u64)
}

/// The promise: 64 MiB and 16 times the bytes.
fn promised(bytes: u64) -> u64 {
    (64 << 20) + 16 * bytes
}

fn check(name: &str, bytes: &[u8], format: Format) {
    let outcome = std::panic::catch_unwind(|| measured(bytes, format));
    let Ok((result, most)) = outcome else {
        panic!("{name}: {:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(2000)]));
    };
    assert!(most <= promised(bytes.len() as u64), "{name}: {most} bytes for {}", bytes.len());
    match result {
        Err(error) => assert!(!error.code.is_empty() && !error.message.is_empty(), "{name}"),
        Ok(ReadOutcome { content: Content::Scene(scene), .. }) => {
            for mesh in scene.parts.iter().map(|part| &part.mesh) {
                assert!(mesh.positions().iter().flatten().all(|x| x.is_finite()), "{name}");
                assert!(mesh.attributes().iter().flat_map(|a| &a.values).all(|x| x.is_finite()), "{name}");
            }
        }
        Ok(ReadOutcome { content: Content::Polygons(polygons), .. }) => {
            assert!(polygons.cage.positions().iter().flatten().all(|x| x.is_finite()), "{name}");
            assert!(polygons.attributes.iter().flat_map(|a| &a.values).all(|x| x.is_finite()), "{name}");
            let n_corners: usize = polygons.cage.faces().map(<[u32]>::len).sum();
            assert!(polygons.cage.texcoords().is_none_or(|t| t.corners.len() == n_corners), "{name}");
        }
        Ok(ReadOutcome { content: Content::Volume(volume), .. }) => {
            let n: usize = volume.grid.size().iter().product();
            assert!(volume.grid.samples().len() == n && n >= 8, "{name}");
        }
        Ok(ReadOutcome { content: Content::Patches(patches, _), .. }) => {
            assert!(patches.iter().all(chordal::Patch::is_finite), "{name}");
        }
        Ok(ReadOutcome { content: Content::Surfaces(surfaces, _), .. }) => {
            let numbers = surfaces.iter().flat_map(|face| face.surface().control().as_flattened());
            assert!(numbers.into_iter().all(|x| x.is_finite()), "{name}");
        }
        Ok(ReadOutcome { content: Content::Drawing(drawing), .. }) => {
            assert!(drawing.lines.iter().all(sound) && drawing.owners.len() == drawing.lines.len(), "{name}");
        }
        Ok(ReadOutcome { content: Content::Curves(curves), .. }) => {
            assert!(curves.lines.iter().all(sound) && curves.owners.len() == curves.lines.len(), "{name}");
        }
        Ok(ReadOutcome { content: Content::Field { field, .. }, .. }) => {
            let mut value = [0.0];
            field.tape().at(&[[0.5, -0.25, 2.0]], &mut value).expect("there is no leaf that could fail");
        }
    }
}

fn sound<const D: usize>(curve: &Curve<D>) -> bool {
    curve.segments().iter().all(CurveSegment::is_finite) && curve.slack().is_finite()
}

#[test]
fn seeds_load() {
    for (format, bytes) in seeds::all() {
        let loaded = read(&bytes, format, &Limits::default());
        assert!(loaded.is_ok(), "{format}: {} {}", loaded.unwrap_err(), String::from_utf8_lossy(&bytes));
        assert_eq!(Format::sniff(&bytes), Some(format));
    }
}

#[test]
fn truncation_anywhere_ends_well() {
    for (format, bytes) in seeds::all() {
        for end in 0..bytes.len().min(512) {
            check("start", &bytes[..end], format);
            check("end", &bytes[..bytes.len() - end], format);
            let _ = Format::sniff(&bytes[..end]);
        }
    }
}

#[test]
fn flipped_bits_end_well() {
    let seed = 31;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for (format, bytes) in seeds::all() {
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[at] ^= 1 << bit;
                check("flip", &flipped, format);
            }
        }
        for _ in 0..2000 {
            let mut flipped = bytes.clone();
            for _ in 0..2 + random.below(6) {
                let at = random.below(flipped.len());
                flipped[at] ^= 1 << random.below(8);
            }
            let _ = Format::sniff(&flipped);
            check("flips", &flipped, format);
        }
    }
}

#[test]
fn other_numbers_in_any_place_end_well() {
    const BINARY: [[u8; 4]; 5] =
        [[0; 4], [1, 0, 0, 0], [0xff; 4], [0xff, 0xff, 0xff, 0x7f], [0, 0, 0xc0, 0x7f]];
    const TEXT: [&str; 8] =
        ["0", "1", "-1", "4294967295", "9223372036854775807", "18446744073709551616", "1e9", "nan"];
    for (format, bytes) in seeds::all() {
        for at in 0..bytes.len().saturating_sub(4) {
            for value in BINARY {
                let mut changed = bytes.clone();
                changed[at..at + 4].copy_from_slice(&value);
                check("binary", &changed, format);
            }
        }
        let is_digit = |b: u8| b.is_ascii_digit() || matches!(b, b'-' | b'.');
        let mut at = 0;
        while at < bytes.len() {
            let end = at + bytes[at..].iter().take_while(|b| is_digit(**b)).count();
            for value in TEXT.iter().filter(|_| end > at) {
                let changed = [&bytes[..at], value.as_bytes(), &bytes[end..]].concat();
                check("text", &changed, format);
            }
            at = end + 1;
        }
    }
}

#[test]
fn lines_repeated_swapped_and_dropped_end_well() {
    let seed = 32;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    for (format, bytes) in seeds::all() {
        let lines: Vec<&[u8]> = bytes.split_inclusive(|b| *b == b'\n').collect();
        for _ in 0..2000 {
            let mut changed = lines.clone();
            for _ in 0..1 + random.below(4) {
                let (i, j) = (random.below(changed.len()), random.below(changed.len()));
                match random.below(3) {
                    0 => changed.swap(i, j),
                    1 => changed.insert(i, changed[j]),
                    _ if changed.len() > 1 => drop(changed.remove(i)),
                    _ => {}
                }
            }
            check("lines", &changed.concat(), format);
        }
    }
}
