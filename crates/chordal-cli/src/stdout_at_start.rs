//! Whether descriptor 1 was open when the process was started.
//!
//! Before `main`, Rust's runtime opens `/dev/null` for reading and writing in place of closed descriptors.
//! Python's `subprocess.DEVNULL` and Node's `'ignore'` do the same on purpose, and writing there is no error.
//! Afterwards the two cases look the same, so the program checks the descriptor before the runtime replaces
//! it.
use std::sync::OnceLock;

/// Whether descriptor 1 was closed at the first check.
static WAS_CLOSED: OnceLock<bool> = OnceLock::new();

/// Checks descriptor 1, at the first call. The program of this crate calls it before `main`. In a process of
/// another language, whose runtime does not replace closed descriptors, the start of a verb is early enough.
/// Closed descriptors are then opened as Rust's runtime does, so that no file opened later gets the number of
/// stdout and the report.
pub fn look_at_stdout() {
    WAS_CLOSED.get_or_init(|| {
        let is_closed = descriptor::is_closed();
        descriptor::fill_gaps();
        is_closed
    });
}

/// Whether the process was started with stdout closed; false if nothing checked it.
pub fn was_closed() -> bool {
    WAS_CLOSED.get().copied().unwrap_or(false)
}

/// Whether stdout is read-only: a file opened for reading, or a folder. The standard library treats the error
/// of such a write as a success. For `/dev/null` that is right, since it discards everything.
pub fn cannot_be_written() -> bool {
    descriptor::is_read_only() && !descriptor::is_null_device()
}

#[cfg(unix)]
mod descriptor {
    use rustix::fs::{FileType, OFlags, fcntl_getfl, fstat, stat};
    use rustix::io::{Errno, fcntl_getfd};
    use rustix::stdio::stdout;
    use std::fs::OpenOptions;
    use std::os::fd::{AsRawFd, IntoRawFd};

    pub fn is_closed() -> bool {
        fcntl_getfd(stdout()).is_err_and(|error| error == Errno::BADF)
    }

    pub fn fill_gaps() {
        // A new descriptor gets the lowest free number; 2 is stderr, the last of the three.
        while let Ok(null) = OpenOptions::new().read(true).write(true).open("/dev/null") {
            if null.as_raw_fd() > 2 {
                break;
            }
            let _ = null.into_raw_fd();
        }
    }

    pub fn is_read_only() -> bool {
        fcntl_getfl(stdout()).is_ok_and(|flags| flags & OFlags::RWMODE == OFlags::RDONLY)
    }

    pub fn is_null_device() -> bool {
        let stats = fstat(stdout()).and_then(|out| Ok((out, stat("/dev/null")?)));
        stats.is_ok_and(|(out, null)| {
            FileType::from_raw_mode(out.st_mode) == FileType::CharacterDevice && out.st_rdev == null.st_rdev
        })
    }
}

#[cfg(not(unix))]
mod descriptor {
    pub fn is_closed() -> bool {
        false
    }

    pub fn fill_gaps() {}

    pub fn is_read_only() -> bool {
        false
    }

    pub fn is_null_device() -> bool {
        false
    }
}
