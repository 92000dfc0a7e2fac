//! Pictures as PNG, read back by the decoder of the same crate: pixels, colour space and text are all there.
use chordal::render::Picture;
use chordal_io::{Limits, WriteError, png};

/// A picture whose pixels all differ, opaque or with every alpha.
fn picture(width: u32, height: u32, opaque: bool) -> Picture {
    let pixel = |i: u32| {
        let alpha = if opaque { 255 } else { (i * 37 % 256) as u8 };
        [(i % 256) as u8, (i / 256 % 256) as u8, (i * i % 251) as u8, alpha]
    };
    Picture { width, height, rgba: (0..width * height).flat_map(pixel).collect() }
}

fn written(picture: &Picture, text: &[(&str, &str)]) -> Vec<u8> {
    let mut file = Vec::new();
    png::write(picture, text, &mut file).expect("writable");
    file
}

fn refusal(picture: &Picture, text: &[(&str, &str)]) -> String {
    let mut file = Vec::new();
    match png::write(picture, text, &mut file) {
        Err(WriteError::Unsupported(message)) => {
            assert!(file.is_empty(), "bytes were written before the refusal");
            message
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn pixels_and_text_read_back() {
    let text = [("Software", "Chordal"), ("Description", "{\"at_most\": 1e-3, \"µ\": \"π\"}")];
    for (opaque, channels) in [(true, 3), (false, 4)] {
        let picture = picture(61, 47, opaque);
        let file = written(&picture, &text);
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&file)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).expect("whole");
        assert_eq!((info.width, info.height), (61, 47));
        let expected: Vec<u8> =
            picture.rgba.chunks_exact(4).flat_map(|pixel| pixel[..channels].to_vec()).collect();
        assert_eq!(bytes, expected);
        assert!(reader.info().srgb.is_some());
        let found: Vec<(String, String)> = reader
            .info()
            .utf8_text
            .iter()
            .map(|chunk| (chunk.keyword.clone(), chunk.get_text().unwrap()))
            .collect();
        assert_eq!(found, text.map(|(keyword, text)| (keyword.to_owned(), text.to_owned())));
    }
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let picture = picture(300, 200, false);
    assert_eq!(written(&picture, &[("Software", "Chordal")]), written(&picture, &[("Software", "Chordal")]));
}

#[test]
fn refuses_what_png_cannot_say() {
    let good = picture(2, 2, true);
    assert!(refusal(&Picture { width: 0, height: 2, rgba: vec![] }, &[]).contains("0x2"));
    assert!(refusal(&Picture { width: 1, height: u32::MAX, rgba: vec![] }, &[]).contains("4294967295"));
    let short = Picture { rgba: good.rgba[..15].to_vec(), ..good.clone() };
    assert!(refusal(&short, &[]).contains("16 bytes, not 15"));
    let long = "k".repeat(80);
    for keyword in ["", " x", "x ", "a  b", "a\nb", "π", long.as_str()] {
        assert!(refusal(&good, &[(keyword, "text")]).contains("keyword"), "{keyword:?}");
    }
    assert!(refusal(&good, &[("Comment", "a\0b")]).contains("NUL"));
    written(&good, &[("Größe", ""), (&long[1..], "text")]);
}

#[test]
fn a_sink_that_fails_gives_its_own_error() {
    struct Full(usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            if self.0 == 0 {
                return Err(std::io::Error::new(std::io::ErrorKind::StorageFull, "no space left"));
            }
            let n = bytes.len().min(self.0);
            self.0 -= n;
            Ok(n)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let picture = picture(64, 64, false);
    let whole = written(&picture, &[]).len();
    for room in 0..whole {
        match png::write(&picture, &[], &mut Full(room)) {
            Err(WriteError::Io(error)) => assert_eq!(error.kind(), std::io::ErrorKind::StorageFull),
            other => panic!("{other:?} with room for {room} of {whole} bytes"),
        }
    }
    png::write(&picture, &[], &mut Full(whole)).expect("room for all");
}

/// A PNG of these samples, as another program may write it.
fn greys_file(
    size: [u32; 2],
    (color, depth): (::png::ColorType, ::png::BitDepth),
    samples: &[u8],
) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(samples).expect("samples");
    writer.finish().expect("written");
    file
}

#[test]
fn greys_of_any_depth_are_read_from_black_to_white() {
    use ::png::{BitDepth, ColorType};
    let read = |file: &[u8]| png::read_greys(file, &Limits::default()).expect("greys");
    let grey = read(&greys_file([3, 1], (ColorType::Grayscale, BitDepth::Eight), &[0, 51, 255]));
    assert_eq!((grey.width, grey.height, grey.values), (3, 1, vec![0.0, 0.2, 1.0]));
    let wide = [0, 0, 0x33, 0x33, 0xff, 0xff, 0, 1];
    let grey = read(&greys_file([2, 2], (ColorType::Grayscale, BitDepth::Sixteen), &wide));
    assert_eq!((grey.width, grey.height, grey.values), (2, 2, vec![0.0, 0.2, 1.0, 1.0 / 65_535.0]));
    // A bit each: the first row is white and black.
    let grey = read(&greys_file([2, 2], (ColorType::Grayscale, BitDepth::One), &[0b1000_0000, 0b0100_0000]));
    assert_eq!(grey.values, [1.0, 0.0, 0.0, 1.0]);
    let rgba = [51, 51, 51, 9, 255, 255, 255, 0];
    assert_eq!(read(&greys_file([2, 1], (ColorType::Rgba, BitDepth::Eight), &rgba)).values, [0.2, 1.0]);
}

#[test]
fn what_are_no_greys_is_refused_in_a_sentence() {
    use ::png::{BitDepth, ColorType};
    let refused = |file: &[u8], limits: &Limits| {
        let error = png::read_greys(file, limits).expect_err("refused");
        (error.code, error.to_string())
    };
    let coloured = greys_file([1, 2], (ColorType::Rgb, BitDepth::Eight), &[7, 7, 7, 7, 8, 7]);
    let (code, message) = refused(&coloured, &Limits::default());
    assert!(code == "coloured" && message.contains("row 2, column 1"), "{message}");
    let good = greys_file([40, 30], (ColorType::Grayscale, BitDepth::Eight), &[9; 1200]);
    for end in 0..good.len() {
        // Without what follows its pixels it may be read.
        if let Err(error) = png::read_greys(&good[..end], &Limits::default()) {
            assert_eq!(error.code, "bad-picture", "{end}");
        } else {
            assert!(2 * end > good.len(), "{end} of {}", good.len());
        }
    }
    let few = Limits { bytes: 1000, ..Limits::default() };
    assert!(png::read_greys(&good, &few).is_err());
    // A header that promises more than it has: the size stands at bytes 16 to 23, but its checksum is wrong then.
    let mut large = good.clone();
    large[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    assert!(png::read_greys(&large, &Limits::default()).is_err());
    let wide = greys_file([4_194_305, 1], (ColorType::Grayscale, BitDepth::One), &vec![0; 524_289]);
    assert_eq!(refused(&wide, &Limits::default()).0, "too-large");
}
