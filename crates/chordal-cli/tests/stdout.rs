//! What a parent may hand over as stdout: what is discarded was written, what is closed, full or not to be written
//! was not.
use crate::common;

use common::{CLOSED_OBJ, Folder, PATCH, Run, chordal};
use std::process::Stdio;
use std::sync::atomic::{AtomicU32, Ordering};

/// A command that prints its report, and one whose output is what it prints.
fn with_each_kind(mut check: impl FnMut(&str, &[&str])) {
    // Tests that run at the same time have folders of their own.
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let folder = Folder::new(&format!("stdout-{}", NEXT.fetch_add(1, Ordering::Relaxed)));
    let (mesh, patch) = (folder.file("a.obj", CLOSED_OBJ), folder.file("a.bpt", PATCH));
    check("report", &["inspect", &mesh]);
    check("report for programs", &["inspect", &mesh, "--json"]);
    check("data", &["mesh", &patch, "-o", "-", "--to", "obj", "--tol", "1e-4", "-q"]);
    check("words", &["language"]);
}

fn with_stdout(args: &[&str], stdout: impl Into<Stdio>) -> Run {
    Run::of(chordal(args).stdout(stdout).stderr(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap())
}

#[test]
fn a_reader_that_went_away_is_a_failed_output_and_no_panic() {
    with_each_kind(|_, args| {
        // Before the command starts, which may be done before its reader is dropped otherwise.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        with_stdout(args, writer).fails_with(4, &["stdout: "]);
    });
}

#[cfg(unix)]
mod unix {
    use super::*;
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use std::fs::{File, OpenOptions};
    use std::io::Read;
    use std::os::fd::OwnedFd;
    use std::os::unix::net::UnixStream;
    use std::process::{Command, Output};

    /// Started by a shell that redirects as `redirections` say.
    fn in_shell(args: &[&str], redirections: &str) -> Output {
        let line = format!("exec \"$0\" \"$@\" {redirections}");
        Command::new("sh")
            .args(["-c", &line, env!("CARGO_BIN_EXE_chordal")])
            .args(args)
            .stdin(Stdio::null())
            .output()
            .unwrap()
    }

    #[test]
    fn discarded_output_is_a_success_however_the_null_device_was_opened() {
        with_each_kind(|kind, args| {
            // Rust and shells open it for writing; Python's `DEVNULL` and Node's 'ignore' for reading as well.
            let both = OpenOptions::new().read(true).write(true).open("/dev/null").unwrap();
            // `open("/dev/null")` of Python opens it for reading alone, and nothing is lost by that.
            let read = File::open("/dev/null").unwrap();
            let all = [with_stdout(args, Stdio::null()), with_stdout(args, both), with_stdout(args, read)];
            all.iter()
                .for_each(|run| assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{kind}: {run:?}"));
            let files = ["> /dev/null", "1<> /dev/null", "1< /dev/null", "<&- 1<> /dev/null 2>&-"];
            for redirections in files {
                let done = in_shell(args, redirections);
                assert_eq!(done.status.code(), Some(0), "{kind} {redirections}: {done:?}");
            }
        });
    }

    #[test]
    fn a_closed_stdout_is_no_success() {
        with_each_kind(|kind, args| {
            for redirections in [">&-", "<&- >&-"] {
                let closed = in_shell(args, redirections);
                assert_eq!(closed.status.code(), Some(4), "{kind} {redirections}: {closed:?}");
                assert!(
                    String::from_utf8_lossy(&closed.stderr).contains("stdout: it is closed"),
                    "{closed:?}"
                );
            }
            assert_eq!(in_shell(args, "<&- >&- 2>&-").status.code(), Some(4), "{kind}");
            // Nobody to tell is no failure.
            assert_eq!(in_shell(args, "2>&-").status.code(), Some(0), "{kind}");
        });
    }

    #[test]
    fn what_cannot_be_written_is_no_success() {
        let folder = Folder::new("stdout-read-only");
        let file = folder.file("in.txt", "for reading");
        with_each_kind(|kind, args| {
            if cfg!(target_os = "linux") {
                let full = in_shell(args, "> /dev/full");
                assert_eq!(full.status.code(), Some(4), "{kind}: {full:?}");
                assert!(String::from_utf8_lossy(&full.stderr).contains("no space left"), "{full:?}");
            }
            for stdout in [File::open("/").unwrap(), File::open(&file).unwrap()] {
                with_stdout(args, stdout).fails_with(4, &["stdout: it is not open for writing"]);
            }
        });
    }

    #[test]
    fn files_sockets_and_terminals_get_all_of_it() {
        let folder = Folder::new("stdout-kinds");
        let path = folder.path("out.txt");
        with_each_kind(|kind, args| {
            // Reports for programs say how long it took: two runs differ there.
            if args.contains(&"--json") {
                return;
            }
            let piped = chordal(args).output().unwrap().stdout;
            with_stdout(args, File::create(&path).unwrap()).succeeds();
            assert_eq!(std::fs::read(&path).unwrap(), piped, "{kind}");

            // What Node calls a pipe is a socket.
            let (mut ours, theirs) = UnixStream::pair().unwrap();
            let read = std::thread::spawn(move || {
                let mut all = Vec::new();
                ours.read_to_end(&mut all).unwrap();
                all
            });
            with_stdout(args, OwnedFd::from(theirs)).succeeds();
            assert_eq!(read.join().unwrap(), piped, "{kind}");

            let shown = in_terminal(args);
            assert_eq!(shown.replace("\r\n", "\n"), String::from_utf8(piped).unwrap(), "{kind}");
        });
    }

    /// What is shown on a terminal.
    fn in_terminal(args: &[&str]) -> String {
        let terminal = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&terminal).unwrap();
        unlockpt(&terminal).unwrap();
        let name = ptsname(&terminal, Vec::new()).unwrap();
        let end = OpenOptions::new().read(true).write(true).open(name.to_str().unwrap()).unwrap();
        let mut terminal = File::from(terminal);
        let read = std::thread::spawn(move || {
            let (mut all, mut block) = (Vec::new(), [0; 4096]);
            // Linux ends what is read with an error once nobody holds the other end.
            while let Ok(n @ 1..) = terminal.read(&mut block) {
                all.extend_from_slice(&block[..n]);
            }
            String::from_utf8(all).unwrap()
        });
        with_stdout(args, end).succeeds();
        read.join().unwrap()
    }

    #[test]
    fn python_and_node_may_discard_what_is_said() {
        let exe = env!("CARGO_BIN_EXE_chordal");
        let python = "import subprocess, sys; d = subprocess.DEVNULL; \
                      sys.exit(subprocess.run(sys.argv[1:], stdin=d, stdout=d, stderr=d).returncode)";
        let node = "const [exe, ...words] = process.argv.slice(1); \
                    process.exit(require('child_process').spawnSync(exe, words, {stdio: 'ignore'}).status)";
        for (program, option, script) in [("python3", "-c", python), ("node", "-e", node)] {
            with_each_kind(|kind, args| {
                match Command::new(program).args([option, script, exe]).args(args).status() {
                    Ok(status) => assert_eq!(status.code(), Some(0), "{program}: {kind}"),
                    Err(error) => eprintln!("SKIPPED: {program}: {error}"),
                }
            });
        }
    }
}
