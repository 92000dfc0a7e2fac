//! What descriptor 1 was when the process was started: open, or closed.
//!
//! Rust's runtime opens `/dev/null` in the place of closed descriptors before `main`, to be read and written. So do
//! Python's `subprocess.DEVNULL` and Node's `'ignore'`, and what they discard is written well: afterwards nothing
//! tells the two apart. Hence the program looks before the runtime does.
use std::sync::OnceLock;

/// Whether nothing was open at 1 when it was first looked at.
static WAS_CLOSED: OnceLock<bool> = OnceLock::new();

/// Looks at descriptor 1, the first time that it is called. The program of this crate calls it before `main`. In the
/// process of another language, whose runtime fills no gaps, a verb is early enough; the gaps are filled then, as
/// Rust's runtime does it, so that no file which is opened later takes the number of stdout and gets the report.
pub fn look_at_stdout() {
    WAS_CLOSED.get_or_init(|| {
        let is_closed = descriptor::is_closed();
        descriptor::fill_gaps();
        is_closed
    });
}

/// Whether the process was started with stdout closed, as far as anything looked early enough.
pub fn was_closed() -> bool {
    WAS_CLOSED.get().copied().unwrap_or(false)
}

/// Whether stdout can be read and not written: a file that is open for reading, or a folder. The standard library
/// takes the error of such a write for a success. Of `/dev/null` it is one: what it gets is discarded anyway.
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
        // A new descriptor gets the lowest number that is free; 2 is stderr, the last of the three.
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
        let both = fstat(stdout()).and_then(|own| Ok((own, stat("/dev/null")?)));
        both.is_ok_and(|(own, null)| {
            FileType::from_raw_mode(own.st_mode) == FileType::CharacterDevice && own.st_rdev == null.st_rdev
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
