//! Chordal as a plain WASM module: numbers and bytes in, numbers and bytes out, without generated glue code.
//!
//! The caller copies bytes into the module's memory and gets a handle to an outcome:
//!
//! ```text
//! input   = chordal_alloc(n)            n bytes to fill; likewise for options, a JSON text
//! outcome = chordal_mesh(input, n, options, m)
//! chordal_exit(outcome)                 0, or the exit code that the command would have ended with
//! chordal_bytes / chordal_bytes_len     the file; empty if there is none
//! chordal_report / chordal_report_len   the certificate as JSON; empty if there is none
//! chordal_error / chordal_error_len     one sentence; empty if there is no error
//! chordal_release(outcome)
//! chordal_free(input, n); chordal_free(options, m)
//! ```
//!
//! Options: `{"name": "teapot.bpt", "to": "glb", "tol": "0.1%", "px": "1", "view": "1920x1080 fov=45 dist=4",
//! "triangles": 5000, "segments": 5000, "from": …, "unit": …, "up": "y", "keep_best": true, "compress":
//! "meshopt", "quantize": true}`. At least one of
//! tol, px with view, triangles and, for curves to polylines, segments. Same input, same options, same
//! version: the same bytes as from the command.
//!
//! A page that shows curves has three more calls. Each takes a JSON object, and its answer is the JSON in the
//! outcome's report:
//!
//! ```text
//! chordal_study(question, n)    {"control": [[x, y] × 4], "segments": 8, "other": 16, "pixels_per_unit": 70, "pixels": 0.5, "t": 0.5, "near": 0.2}
//! chordal_ladder(question, n)   {"control": …, "counts": [1, 2, 4, …], "pixels_per_unit": 70}
//! chordal_seam(question, n)     {"first": [[x, y] × 4], "second": …, "smoothness": "C1", "leader": "first", "scale": 0.5}
//! ```
//!
//! Each exhibit of the studio has a call of its own, and large arrays of the answer are in the outcome's bytes:
//!
//! ```text
//! chordal_exhibit_quad(question, n)  {"exhibit": "quad", …}; an array of the answer is {"f32": [start, length]} or {"u32": …}
//! ```
//!
//! Growing the memory detaches JavaScript's views of it: make a new `Uint8Array` after every call.
mod curve_join;
mod curve_request;
#[cfg(feature = "exhibits")]
mod exhibits;
#[cfg(feature = "files")]
mod mesh;
#[cfg(feature = "files")]
mod options;
mod outcome;
#[cfg(feature = "files")]
mod spelling;
mod study;

use outcome::Outcome;

#[cfg(target_os = "wasi")]
unsafe extern "C" {
    /// Of wasi-libc: makes the caller its first thread.
    fn __wasi_init_tp();
    /// Of the linker: runs what runs before `main` elsewhere.
    fn __wasm_call_ctors();
}

/// To be called first, in the module for `wasm32-wasip1-threads`: without it libc's list of threads is empty and has no
/// end, on which the first value that belongs to a thread waits for ever. Programs have it in their start, for which Rust
/// has no counterpart in libraries. The plain module has no libc.
#[cfg(target_os = "wasi")]
#[unsafe(no_mangle)]
pub extern "C" fn _initialize() {
    // SAFETY: the host calls this once, before anything else, as WASI asks of it.
    unsafe {
        __wasi_init_tp();
        __wasm_call_ctors();
    }
}

/// Allocates `len` zeroed bytes. Never null: a module that runs out of memory traps.
#[unsafe(no_mangle)]
pub extern "C" fn chordal_alloc(len: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; len].into_boxed_slice()).cast()
}

/// Frees bytes.
///
/// # Safety
/// `at` and `len` are from one call of [`chordal_alloc`] and were not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn chordal_free(at: *mut u8, len: usize) {
    // SAFETY: by the contract this is the slice that `chordal_alloc` leaked, and it is freed only here.
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(at, len)) });
}

/// Turns the shape in `input` into triangles, as `options` say.
///
/// # Safety
/// Each pair of an address and a length is from one call of [`chordal_alloc`] and was not freed.
#[cfg(feature = "files")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn chordal_mesh(
    input: *const u8,
    input_len: usize,
    options: *const u8,
    options_len: usize,
) -> *mut Outcome {
    // SAFETY: by the contract both are initialized, live and of that length, and nothing writes to them
    // during the call, since a WASM module like this one has one thread.
    let (input, options) = unsafe {
        (std::slice::from_raw_parts(input, input_len), std::slice::from_raw_parts(options, options_len))
    };
    Box::into_raw(Box::new(mesh::mesh(input, options)))
}

/// Exports a function from one JSON object to another.
macro_rules! questions {
    ($($(#[$doc:meta])+ $name:ident: $answer:path;)*) => {$(
        $(#[$doc])+
        ///
        /// # Safety
        /// `question` and `len` are from one call of [`chordal_alloc`] and were not freed.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(question: *const u8, len: usize) -> *mut Outcome {
            // SAFETY: by the contract it is initialized, live and of that length, and nothing writes to it
            // during the call, since a WASM module like this one has one thread.
            let question = unsafe { std::slice::from_raw_parts(question, len) };
            Box::into_raw(Box::new(outcome::answer($answer(question))))
        }
    )*};
}

questions! {
    /// One cubic with a number of segments: both chains, their gaps and bounds, the same for another number,
    /// the number of segments for a tolerance, by proof and by formula, and de Casteljau's construction.
    chordal_study: study::study;
    /// The error of one cubic by the number of segments.
    chordal_ladder: study::ladder;
    /// Two cubics joined smoothly, their join, and the combs of their curvature.
    chordal_seam: curve_join::curve_join;
}

/// 0, or the exit code that the command would have ended with.
///
/// # Safety
/// `outcome` is from [`chordal_study`] or another call, and was not released; likewise below.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn chordal_exit(outcome: *const Outcome) -> u32 {
    // SAFETY: by the contract it is a live box that nothing writes to.
    u32::from(unsafe { &*outcome }.exit)
}

/// Exports the start and the length of one of an outcome's byte strings.
macro_rules! bytes {
    ($(#[$doc:meta] $field:ident: $start:ident, $len:ident;)*) => {$(
        #[$doc]
        ///
        /// # Safety
        /// As for [`chordal_exit`]; the bytes live until the release.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $start(outcome: *const Outcome) -> *const u8 {
            // SAFETY: by the contract it is a live box that nothing writes to.
            unsafe { &*outcome }.$field.as_ptr()
            }

            /// The number of these bytes.
        ///
        /// # Safety
        /// As for [`chordal_exit`].
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $len(outcome: *const Outcome) -> usize {
            // SAFETY: by the contract it is a live box that nothing writes to.
            unsafe { &*outcome }.$field.len()
        }
    )*};
}

bytes! {
    /// The bytes of the file.
    bytes: chordal_bytes, chordal_bytes_len;
    /// The certificate as JSON.
    report: chordal_report, chordal_report_len;
    /// The error, as one sentence.
    error: chordal_error, chordal_error_len;
}

/// Frees an outcome.
///
/// # Safety
/// `outcome` is from [`chordal_study`] or another call, and was not released before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn chordal_release(outcome: *mut Outcome) {
    // SAFETY: by the contract this is a box that one of the calls leaked, and it is dropped only here.
    drop(unsafe { Box::from_raw(outcome) });
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;

    const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    fn into_raw(bytes: &[u8]) -> (*mut u8, usize) {
        let at = chordal_alloc(bytes.len());
        // SAFETY: as many bytes were just allocated.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), at, bytes.len()) };
        (at, bytes.len())
    }

    /// Exit code, file, certificate, error.
    fn call(input: &[u8], options: &str) -> (u32, Vec<u8>, String, String) {
        let (input, options) = (into_raw(input), into_raw(options.as_bytes()));
        // SAFETY: everything is from `chordal_alloc` and `chordal_mesh`, and is freed once, at the end.
        unsafe {
            let outcome = chordal_mesh(input.0, input.1, options.0, options.1);
            let copy = |at: *const u8, len: usize| std::slice::from_raw_parts(at, len).to_vec();
            let text = |at, len| String::from_utf8(copy(at, len)).unwrap();
            let results = (
                chordal_exit(outcome),
                copy(chordal_bytes(outcome), chordal_bytes_len(outcome)),
                text(chordal_report(outcome), chordal_report_len(outcome)),
                text(chordal_error(outcome), chordal_error_len(outcome)),
            );
            chordal_release(outcome);
            chordal_free(input.0, input.1);
            chordal_free(options.0, options.1);
            results
        }
    }

    #[test]
    fn meshes_through_the_raw_interface() {
        let options = r#"{"name": "t.obj", "to": "glb", "tol": "1%"}"#;
        let (exit, bytes, report, error) = call(TRIANGLE, options);
        assert_eq!((exit, error.as_str()), (0, ""));
        assert_eq!(&bytes[..4], b"glTF");
        assert!(report.contains("\"proved\""), "{report}");
        assert_eq!(call(TRIANGLE, options).1, bytes);
    }

    #[test]
    fn says_what_is_wrong_in_one_sentence_and_with_the_command_s_exit_code() {
        for (input, options, exit, part) in [
            (TRIANGLE, "", 2, "options"),
            (TRIANGLE, r#"{"to": "glb", "tol": 1e-3, "colour": "red"}"#, 2, "colour"),
            (TRIANGLE, r#"{"name": "t.obj", "to": "glb"}"#, 2, "tol"),
            (TRIANGLE, r#"{"name": "t.obj", "to": "glb", "tol": "-1"}"#, 2, "greater than 0"),
            (TRIANGLE, r#"{"name": "t.obj", "to": "glb", "px": "1"}"#, 2, "view"),
            (TRIANGLE, r#"{"name": "t.obj", "to": "ply", "tol": "1", "quantize": true}"#, 2, "glb"),
            (TRIANGLE, r#"{"name": "t.obj", "to": "bpt", "tol": "1"}"#, 2, "can only be read"),
            (b"v 0 0", r#"{"name": "t.obj", "to": "glb", "tol": "1"}"#, 3, "line 1"),
            (b"", r#"{"to": "glb", "tol": "1"}"#, 3, "empty"),
        ] {
            let (code, bytes, _, error) = call(input, options);
            assert_eq!(code, exit, "{options}: {error}");
            assert!(error.contains(part) && bytes.is_empty(), "{options}: {error}");
        }
    }

    #[test]
    fn quantizes_a_glb_where_it_is_asked_to() {
        let options = r#"{"name": "t.obj", "to": "glb", "tol": "0.001", "quantize": true}"#;
        let (exit, bytes, report, error) = call(TRIANGLE, options);
        assert_eq!((exit, error.as_str()), (0, ""));
        assert!(String::from_utf8_lossy(&bytes).contains("KHR_mesh_quantization"), "{report}");
    }

    #[test]
    fn keeps_the_best_only_when_told_to() {
        let solid = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
        let kept = call(solid, r#"{"name": "s.obj", "to": "ply", "triangles": 3, "keep_best": true}"#);
        let lost = call(solid, r#"{"name": "s.obj", "to": "ply", "triangles": 3}"#);
        assert_eq!((kept.0, lost.0), (5, 5));
        assert!(!kept.1.is_empty() && lost.1.is_empty());
    }
}
