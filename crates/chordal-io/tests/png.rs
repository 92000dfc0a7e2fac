//! Pictures as PNG, read back by the decoder of the same crate: pixels, colour space and text are all there.
use chordal::render::Picture;
use chordal_io::{WriteError, png};

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
