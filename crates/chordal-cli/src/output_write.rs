//! Writes an output of one file atomically.
use crate::console::check_stdout;
use crate::fault::Fault;
use crate::output::OutputTarget;
use crate::temp_output::{OutputWriter, TempOutput, unwritable};
use chordal_io::WriteError;
use std::io::{self, Write};

impl OutputTarget {
    /// Writes the output of `fill` atomically and returns the number of bytes.
    ///
    /// # Errors
    /// If `fill` or the system fails; then an existing file is unchanged.
    pub fn write(&self, fill: OutputWriter) -> Result<u64, Fault> {
        let name = self.name();
        let failed = |error: WriteError| unwritable(&name, &error);
        match self {
            Self::Stdout => {
                check_stdout()?;
                // In memory first, so that a failure writes nothing instead of a part.
                let mut bytes = Vec::new();
                fill(&mut bytes).map_err(failed)?;
                let mut stdout = io::stdout().lock();
                stdout.write_all(&bytes).and_then(|()| stdout.flush()).map_err(|e| failed(e.into()))?;
                Ok(bytes.len() as u64)
            }
            Self::File { path, existing } => {
                let mut temp = TempOutput::create(path)?;
                let bytes = temp.fill(fill).map_err(failed)?;
                temp.commit(path, *existing)?;
                Ok(bytes)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::Exit;
    use crate::input::InputSource;
    use crate::overwrite::OverwritePolicy;
    use chordal_testkit::Folder;
    use std::fs;

    #[test]
    fn h79_a_writer_that_fails_half_way_leaves_the_old_file_and_nothing_else() {
        let folder = Folder::new("output-fails");
        let path = folder.path("out.bin");
        fs::write(&path, "old").unwrap();
        let target = OutputTarget::prepare(&path, OverwritePolicy::Replace, &InputSource::Stdin).unwrap();
        let fault = target
            .write(&mut |out| {
                out.write_all(&[1; 100_000])?;
                Err(io::Error::from(io::ErrorKind::StorageFull).into())
            })
            .unwrap_err();
        assert_eq!(fault.exit, Exit::Output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn replaces_a_file_only_when_told_to() {
        let folder = Folder::new("output-replaces");
        let path = folder.path("out.bin");
        let new = |existing| {
            OutputTarget::prepare(&path, existing, &InputSource::Stdin)?
                .write(&mut |out| Ok(out.write_all(b"new")?))
        };
        assert_eq!(new(OverwritePolicy::Keep).unwrap(), 3);
        fs::write(&path, "old").unwrap();
        assert_eq!(new(OverwritePolicy::Keep).unwrap_err().code, "output-exists");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(new(OverwritePolicy::Replace).unwrap(), 3);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn keeps_a_file_that_appears_during_the_work() {
        let folder = Folder::new("output-appears");
        let path = folder.path("out.bin");
        let target = OutputTarget::prepare(&path, OverwritePolicy::Keep, &InputSource::Stdin).unwrap();
        let fault = target
            .write(&mut |out| {
                fs::write(&path, "somebody else's")?;
                Ok(out.write_all(b"mine")?)
            })
            .unwrap_err();
        assert_eq!(fault.code, "output-exists");
        assert_eq!(fs::read(&path).unwrap(), b"somebody else's");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn an_output_folder_that_is_missing_is_known_before_the_work() {
        let path = std::env::temp_dir().join("chordal-no-such-folder/out.bin");
        let fault = OutputTarget::prepare(&path, OverwritePolicy::Replace, &InputSource::Stdin).unwrap_err();
        assert_eq!(fault.exit, Exit::Output);
        assert!(fault.lines[0].contains("no such file or directory"), "{fault}");
    }
}
