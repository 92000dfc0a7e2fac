//! Reads a file or stdin completely; refuses paths that are no regular files before reading.
use crate::fault::{Fault, plainly};
use std::fs::{File, Metadata, OpenOptions};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The source of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputSource {
    /// `-`.
    Stdin,
    /// A file.
    File(PathBuf),
}

impl InputSource {
    /// `-` is stdin; anything else is a path.
    pub fn from_arg(arg: &Path) -> Self {
        if arg.as_os_str() == "-" { Self::Stdin } else { Self::File(arg.to_owned()) }
    }

    /// The name in messages and reports.
    pub fn name(&self) -> String {
        match self {
            Self::Stdin => "stdin".to_owned(),
            Self::File(path) => path.display().to_string(),
        }
    }

    /// All bytes, at most `limit`.
    ///
    /// # Errors
    /// If it is no regular file, cannot be read, is larger than `limit`, or changes while it is read.
    pub fn read(&self, limit: u64) -> Result<Vec<u8>, Fault> {
        let name = self.name();
        match self {
            Self::Stdin => read_up_to(&mut std::io::stdin().lock(), limit, &name),
            Self::File(path) => {
                let mut file = open_regular(path, &name)?;
                let size = metadata(&file, &name)?.len();
                if size > limit {
                    return Err(too_large(&name, size, limit));
                }
                read_unchanged(&mut file, &name, |file| read_up_to(file, limit, &name))
            }
        }
    }
}

/// Opens `path` if it is a regular file. This is checked first for the path, so that a device or a pipe is
/// not even opened, and again for the open file, in case the path was replaced in between.
fn open_regular(path: &Path, name: &str) -> Result<File, Fault> {
    let io = |error: std::io::Error| Fault::input("unreadable", format!("{name}: {}", plainly(&error)));
    refuse_irregular(&std::fs::metadata(path).map_err(io)?, name)?;
    let file = open_without_waiting(path).map_err(io)?;
    refuse_irregular(&metadata(&file, name)?, name)?;
    Ok(file)
}

/// Opens without blocking: opening a pipe would wait for its other end.
fn open_without_waiting(path: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK | libc::O_CLOEXEC);
    options.open(path)
}

/// The result of `read`, unless the file changed meanwhile: half of one version and half of another would be
/// a shape that never existed.
fn read_unchanged<T>(
    file: &mut File,
    name: &str,
    read: impl FnOnce(&mut File) -> Result<T, Fault>,
) -> Result<T, Fault> {
    let before = metadata(file, name)?;
    let content = read(file)?;
    let after = metadata(file, name)?;
    if before.len() != after.len() || before.modified().ok() != after.modified().ok() {
        return Err(Fault::input("changed", format!("{name}: the file changed while it was read")));
    }
    Ok(content)
}

fn metadata(file: &File, name: &str) -> Result<Metadata, Fault> {
    file.metadata().map_err(|error| Fault::input("unreadable", format!("{name}: {}", plainly(&error))))
}

fn refuse_irregular(metadata: &Metadata, name: &str) -> Result<(), Fault> {
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a device, pipe or socket" };
    Err(Fault::input("not-a-file", format!("{name}: this is {what}, not a file; '-' reads stdin")))
}

fn too_large(name: &str, bytes: u64, limit: u64) -> Fault {
    Fault::input(
        "too-large",
        format!("{name}: the file has {bytes} bytes; the limit is {limit} (--max-memory)"),
    )
}

/// Reads at most `limit` bytes. The buffer grows with the data, never by an announced size.
fn read_up_to(reader: &mut dyn Read, limit: u64, name: &str) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells a stream at the limit from one beyond it.
    let read = reader.take(limit.saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|error| Fault::input("unreadable", format!("{name}: {}", plainly(&error))))?;
    if bytes.len() as u64 > limit {
        return Err(Fault::input(
            "too-large",
            format!("{name}: there are more than {limit} bytes, which is the limit (--max-memory)"),
        ));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::Exit;
    use chordal_testkit::Folder;

    #[test]
    fn stops_at_the_limit() {
        let mut endless = std::io::repeat(7);
        let fault = read_up_to(&mut endless, 1000, "x").unwrap_err();
        assert_eq!(fault.exit, Exit::Input);
        assert!(fault.lines[0].contains("1000"));
        assert_eq!(read_up_to(&mut &[1_u8, 2][..], 2, "x").unwrap(), [1, 2]);
    }

    #[test]
    fn h78_a_file_that_changes_while_it_is_read_is_refused() {
        let folder = Folder::new("h78");
        let path = folder.file("a.obj", "v 0 0 0\n");
        let mut file = File::open(&path).unwrap();
        let calm = read_unchanged(&mut file, "x", |file| read_up_to(file, 100, "x")).unwrap();
        assert_eq!(calm, b"v 0 0 0\n");
        for content in ["v 0 0 0\nv 1", "v"] {
            let disturbed = read_unchanged(&mut file, "x", |_| {
                std::fs::write(&path, content).unwrap();
                Ok(())
            });
            assert_eq!(disturbed.unwrap_err().code, "changed");
        }
    }

    #[test]
    fn refuses_a_folder() {
        let fault = InputSource::File(std::env::temp_dir()).read(10).unwrap_err();
        assert_eq!((fault.exit, fault.code), (Exit::Input, "not-a-file"));
    }
}
