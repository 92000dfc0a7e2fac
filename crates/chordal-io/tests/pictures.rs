//! Pictures as JPEG and WebP, read back by decoders: pixels and text are all there.
use chordal::render::Picture;
use chordal_io::{PictureFormat, WriteError};
use image::ImageDecoder;
use std::io::Cursor;

/// Smooth colours; opaque, or with every alpha.
fn picture(width: u32, height: u32, opaque: bool) -> Picture {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let alpha = if opaque { 255 } else { (i % 256) as u8 };
        [(x * 255 / width) as u8, (y * 255 / height) as u8, ((x + y) * 255 / (width + height)) as u8, alpha]
    };
    Picture { width, height, rgba: (0..width * height).flat_map(pixel).collect() }
}

fn written(picture: &Picture, format: PictureFormat, text: &[(&str, &str)]) -> Vec<u8> {
    let mut file = Vec::new();
    format.write(picture, text, &mut file).expect("writable");
    file
}

#[test]
fn webp_keeps_every_pixel_and_the_text() {
    let text = [("Software", "Chordal"), ("chordal", "{\"at_most\": 1e-3, \"<\": \"& \u{b5}\"}")];
    for (opaque, channels) in [(true, 3), (false, 4)] {
        let picture = picture(61, 47, opaque);
        let file = written(&picture, PictureFormat::Webp, &text);
        let mut decoder = image_webp::WebPDecoder::new(Cursor::new(&file)).expect("a WebP");
        assert_eq!((decoder.dimensions(), decoder.has_alpha()), ((61, 47), !opaque));
        let mut bytes = vec![0; decoder.output_buffer_size().unwrap()];
        decoder.read_image(&mut bytes).expect("whole");
        let pixels = picture.rgba.chunks_exact(4);
        assert_eq!(bytes, pixels.flat_map(|pixel| pixel[..channels].to_vec()).collect::<Vec<u8>>());
        let xmp = String::from_utf8(decoder.xmp_metadata().unwrap().expect("metadata")).unwrap();
        assert!(xmp.contains("Software: Chordal&#10;chordal: {"), "{xmp}");
        let mut reader = quick_xml::Reader::from_str(&xmp);
        while reader.read_event().expect("XML") != quick_xml::events::Event::Eof {}
    }
}

#[test]
fn jpeg_keeps_smooth_colours_on_white_and_the_text() {
    for opaque in [true, false] {
        let picture = picture(61, 47, opaque);
        // Longer than a comment holds.
        let long = "x".repeat(70_000);
        let file = written(&picture, PictureFormat::Jpeg, &[("Software", "Chordal"), ("chordal", &long)]);
        let decoder = image::codecs::jpeg::JpegDecoder::new(Cursor::new(&file)).expect("a JPEG");
        assert_eq!(decoder.dimensions(), (61, 47));
        let mut bytes = vec![0; decoder.total_bytes() as usize];
        decoder.read_image(&mut bytes).expect("whole");
        let mut off = 0.0;
        for (pixel, found) in picture.rgba.chunks_exact(4).zip(bytes.chunks_exact(3)) {
            let alpha = f64::from(pixel[3]) / 255.0;
            for k in 0..3 {
                let expected = f64::from(pixel[k]) * alpha + 255.0 * (1.0 - alpha);
                off += (expected - f64::from(found[k])).abs();
            }
        }
        // Of 255 levels; the alpha that runs through all its values on a row and jumps is what JPEG is bad at.
        let mean = off / bytes.len() as f64;
        assert!(mean < if opaque { 1.5 } else { 4.0 }, "off by {mean} of 255");
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("Software: Chordal"));
        let n_x: usize = text.matches(&"x".repeat(100)).count();
        // The long text is there in two pieces, of which one ends in the middle of a hundred.
        assert!(n_x >= 698, "{n_x}");
    }
}

#[test]
fn what_a_format_does_not_hold_is_refused_before_a_byte_is_written() {
    for (format, side) in [(PictureFormat::Jpeg, 65_536), (PictureFormat::Webp, 16_385)] {
        for picture in [
            Picture { width: side, height: 1, rgba: vec![0; 4 * side as usize] },
            Picture { width: 0, height: 1, rgba: Vec::new() },
            Picture { width: 2, height: 2, rgba: vec![0; 15] },
        ] {
            let mut file = Vec::new();
            let refused = format.write(&picture, &[], &mut file);
            assert!(matches!(refused, Err(WriteError::Unsupported(_))), "{refused:?}");
            assert!(file.is_empty());
        }
        let most = Picture { width: side - 1, height: 1, rgba: vec![255; 4 * (side - 1) as usize] };
        assert!(!written(&most, format, &[]).is_empty());
    }
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let picture = picture(300, 200, true);
    for format in [PictureFormat::Jpeg, PictureFormat::Webp] {
        let files = [(); 2].map(|()| written(&picture, format, &[("Software", "Chordal")]));
        assert!(files[0] == files[1], "{format:?}");
    }
}
