//! `Bridge`: a process of the Python package that is a client of a Dask cluster. Jobs and their ends are
//! lines of JSON.
//!
//! ```text
//! BatchWork --- job: a line on stdin --->  client  ---> scheduler, workers
//!           <-- end: a line on stdout ---
//! ```
use super::job::{BatchJob, JobEnd, JobFault};
use crate::fault::{Fault, plainly};
use crate::signal::{self, SharedChild};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// The files given to the cluster per thread of a worker. Defined: one in progress and the next, so that no
/// thread waits.
const FILES_PER_THREAD: usize = 2;

/// The most files that are given to the cluster at once without `--jobs`. Derived: each has a waiting thread
/// here, and a disk takes about as many lines of the manifest in a second.
const MOST_AT_ONCE: usize = 1000;

/// The settings of a bridge.
#[derive(Clone, Debug)]
pub struct BridgeArgs<'a> {
    /// The words that start the process.
    pub program: &'a [OsString],
    /// The address of the scheduler.
    pub address: &'a str,
    /// The number of files at once, if given.
    pub jobs: Option<usize>,
    /// Whether each process gets a share of its worker's memory as its limit.
    pub shares_memory: bool,
}

/// The client process, with the threads that wait for its answers.
#[derive(Debug)]
pub struct Bridge {
    jobs: Option<usize>,
    shares_memory: bool,
    cwd: PathBuf,
    /// `None` once the bridge is being dropped.
    stdin: Option<Mutex<ChildStdin>>,
    reader: Option<JoinHandle<()>>,
    state: Arc<BridgeState>,
}

#[derive(Debug, Default)]
struct BridgeState {
    /// Threads of all workers.
    slots: AtomicUsize,
    waiting: Mutex<WaitingJobs>,
}

#[derive(Debug, Default)]
struct WaitingJobs {
    by_number: BTreeMap<u64, Sender<Value>>,
    /// Why no job will end any more.
    fault: Option<String>,
}

impl BridgeState {
    fn waiting(&self) -> MutexGuard<'_, WaitingJobs> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Handles a line of the process.
    fn handle_line(&self, line: &str) {
        let Ok(message) = serde_json::from_str::<Value>(line) else {
            // The line may have been the end of a job, whose thread would wait for ever.
            return self.end("the client of the cluster wrote a line that is not JSON".to_owned());
        };
        if let Some(slots) = message.get("slots").and_then(Value::as_u64) {
            self.slots.store(usize::try_from(slots).unwrap_or(usize::MAX), Ordering::Relaxed);
        }
        // A fault of the cluster and not of a file, which ends the batch: a worker that fails at once
        // would take all files.
        if let Some(fault) = message.get("fault").and_then(Value::as_str) {
            self.end(fault.to_owned());
        }
        if let Some(number) = message.get("job").and_then(Value::as_u64)
            && let Some(waiter) = self.waiting().by_number.remove(&number)
        {
            // The receiver may be gone.
            let _ = waiter.send(message);
        }
    }

    /// Ends all waiting jobs with a reason; the first reason stays.
    fn end(&self, fault: String) {
        let mut waiting = self.waiting();
        waiting.fault.get_or_insert(fault);
        // Without its sender, each waiting thread wakes up.
        waiting.by_number.clear();
    }
}

impl Bridge {
    /// Starts the process, and waits until it has reached the scheduler.
    ///
    /// # Errors
    /// If the process or its connection fails.
    pub fn start(args: &BridgeArgs) -> Result<Self, Fault> {
        let cwd = std::env::current_dir().map_err(|error| not_started(&error))?;
        let mut words = args.program.iter();
        let mut command = Command::new(words.next().cloned().unwrap_or_default());
        command.args(words).arg(args.address);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = signal::start_child(&mut command).map_err(|error| not_started(&error))?;
        let (stdin, stdout, stderr) = {
            let mut child = child.lock().unwrap_or_else(PoisonError::into_inner);
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        };
        let state = Arc::new(BridgeState::default());
        let (ready, is_ready) = channel();
        let reader = {
            let state = Arc::clone(&state);
            let stderr = thread::spawn(move || last_line(stderr));
            thread::spawn(move || {
                read_lines(&state, stdout, &ready);
                let last = stderr.join().unwrap_or_default();
                wait_for(&child);
                state.end(format!("the client of the cluster has ended{last}"));
            })
        };
        // The first line has the number of threads or a fault. An error here means that the process has
        // ended.
        let _ = is_ready.recv();
        let stdin = stdin.map(Mutex::new);
        let bridge = Self {
            jobs: args.jobs,
            shares_memory: args.shares_memory,
            cwd,
            stdin,
            reader: Some(reader),
            state,
        };
        let fault = bridge.state.waiting().fault.clone();
        fault.map_or(Ok(bridge), |sentence| Err(cluster_fault(sentence)))
    }

    /// The threads of all workers.
    pub fn slots(&self) -> usize {
        self.state.slots.load(Ordering::Relaxed)
    }

    /// The number of files given to the cluster at once.
    pub fn at_once(&self) -> usize {
        self.jobs.unwrap_or_else(|| self.slots().saturating_mul(FILES_PER_THREAD).clamp(1, MOST_AT_ONCE))
    }

    /// Runs one job, and waits for its end.
    ///
    /// # Errors
    /// If the cluster cannot run jobs of this batch.
    pub fn run(&self, job: &BatchJob) -> Result<JobEnd, JobFault> {
        let (sender, receiver) = channel();
        {
            // Registered before the line is sent, since the answer may be faster than this thread. The
            // lock is given back first: the pipe may be full, and the thread that reads answers needs it.
            let mut waiting = self.state.waiting();
            if let Some(sentence) = &waiting.fault {
                return Err(JobFault::Batch(cluster_fault(sentence.clone())));
            }
            waiting.by_number.insert(job.number as u64, sender);
        }
        let line = self.line(job);
        if let Some(stdin) = &self.stdin {
            let mut stdin = stdin.lock().unwrap_or_else(PoisonError::into_inner);
            // If the process has ended, the reader thread reports it.
            let _ = stdin.write_all(line.as_bytes());
        }
        match receiver.recv() {
            Ok(message) => Ok(end_of(&message, job)),
            Err(_) => {
                let sentence = self.state.waiting().fault.clone();
                Err(JobFault::Batch(cluster_fault(sentence.unwrap_or_default())))
            }
        }
    }

    /// The job as the Python package reads it (`_batch_job.py`).
    fn line(&self, job: &BatchJob) -> String {
        let names = |words: &[OsString]| words.iter().map(|word| name_value(word)).collect::<Vec<_>>();
        let work = std::path::absolute(job.work_folder).unwrap_or_else(|_| job.work_folder.to_owned());
        let job = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "cwd": name_value(self.cwd.as_os_str()),
            "input": name_value(job.input.as_os_str()),
            "is_there": job.input.exists(),
            "work": name_value(work.as_os_str()),
            "number": job.number,
            "name": name_value(&job.name),
            "is_report": job.is_report,
            "head": names(&job.head),
            "tail": names(&job.tail),
            "shares_memory": self.shares_memory,
            "timeout": job.timeout.map(|timeout| timeout.as_secs_f64()),
        });
        job.to_string() + "\n"
    }
}

impl Drop for Bridge {
    /// Closing its stdin ends the process, which cancels running jobs.
    fn drop(&mut self) {
        self.stdin = None;
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

/// Handles all lines. Signals `ready` at each; dropping `ready` tells that there are no more.
fn read_lines(state: &BridgeState, stdout: Option<ChildStdout>, ready: &Sender<()>) {
    let lines = stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines());
    for line in lines.map_while(Result::ok) {
        state.handle_line(&line);
        let _ = ready.send(());
    }
}

/// Waits for the end of the process. While the signal handler ends the command this blocks, so that the
/// killed process is not reported as an error.
fn wait_for(child: &SharedChild) {
    let _ = child.lock().unwrap_or_else(PoisonError::into_inner).wait();
    signal::forget_child(child);
}

/// The last line of a process's stderr, as the end of a sentence.
fn last_line(stderr: Option<impl Read>) -> String {
    let lines = stderr.into_iter().flat_map(|stderr| BufReader::new(stderr).lines().map_while(Result::ok));
    lines
        .filter(|line| !line.trim().is_empty())
        .last()
        .map_or_else(String::new, |line| format!(": {}", line.trim()))
}

/// A name as text, or as bytes if it is not Unicode.
fn name_value(name: &OsStr) -> Value {
    name.to_str().map_or_else(|| json!(name.as_encoded_bytes()), |text| json!(text))
}

/// The end of a job from its message.
fn end_of(message: &Value, job: &BatchJob) -> JobEnd {
    let text = |key: &str| message.get(key).and_then(Value::as_str);
    let mut end = JobEnd {
        // Without a folder there is no output.
        // Each try has a folder of its own, so that a worker that was given up disturbs nobody; the
        // answer names it.
        output: text("folder")
            .map_or_else(PathBuf::new, |folder| job.work_folder.join(folder).join(&job.name)),
        exit: message.get("exit").and_then(Value::as_i64).and_then(|exit| i32::try_from(exit).ok()),
        why: text("why").map(str::to_owned),
        code: text("code").map(str::to_owned),
        stdout: text("stdout").unwrap_or_default().into(),
        stderr: text("stderr").unwrap_or_default().into(),
        seconds: message.get("seconds").and_then(Value::as_f64),
    };
    if message.get("timed_out").is_some() {
        end.timed_out(job.timeout);
    }
    end
}

fn not_started(error: &io::Error) -> Fault {
    cluster_fault(format!("the client of the cluster cannot be started: {}", plainly(error)))
}

fn cluster_fault(sentence: String) -> Fault {
    Fault::output("cluster", sentence)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::path::Path;

    /// A bridge to a shell script in place of Python.
    fn start(script: &str, jobs: Option<usize>) -> Result<Bridge, Fault> {
        let program = ["sh", "-c", script].map(OsString::from);
        Bridge::start(&BridgeArgs { program: &program, address: "tcp://a:1", jobs, shares_memory: true })
    }

    fn job(number: usize) -> BatchJob<'static> {
        BatchJob {
            number,
            input: "in.obj".into(),
            name: "out.glb".into(),
            is_report: false,
            head: vec!["mesh".into()],
            tail: Vec::new(),
            work_folder: Path::new("work"),
            timeout: None,
        }
    }

    fn sentence(fault: JobFault) -> String {
        match fault {
            JobFault::Batch(fault) => fault.lines.join("; "),
            JobFault::File(fault) => panic!("{fault:?}"),
        }
    }

    #[test]
    fn each_job_gets_its_own_end_in_whatever_order_they_come() {
        let script = r#"echo '{"slots":3}'; read a; read b; echo "$a$b" | grep -q '"name":"out.glb".*"timeout":null' || exit
            echo '{"slots":5}'; echo '{"job":1,"exit":0,"folder":"1.x","seconds":2.5}'
            echo '{"job":0,"exit":null,"why":"killed","code":"killed-worker"}'; read c"#;
        let bridge = start(script, None).unwrap();
        assert_eq!((bridge.slots(), bridge.at_once()), (3, 6));
        let ends: Vec<JobEnd> = thread::scope(|scope| {
            let threads = [0, 1].map(|number| {
                scope.spawn({
                    let bridge = &bridge;
                    move || bridge.run(&job(number))
                })
            });
            threads.map(|thread| thread.join().unwrap().unwrap()).into()
        });
        assert_eq!((ends[0].exit, ends[0].why.as_deref()), (None, Some("killed")));
        assert_eq!((ends[0].code.as_deref(), &ends[0].output), (Some("killed-worker"), &PathBuf::new()));
        assert_eq!((ends[1].exit, ends[1].seconds), (Some(0), Some(2.5)));
        assert_eq!(ends[1].output, Path::new("work/1.x/out.glb"));
        assert_eq!(bridge.at_once(), 10);
    }

    #[test]
    fn whoever_waits_is_told_why_there_is_no_end() {
        let fault_of = |script: &str| sentence(start(script, Some(7)).unwrap().run(&job(0)).unwrap_err());
        assert_eq!(fault_of(r#"echo '{"slots":1}'; read a; echo '{"fault":"gone"}'; read b"#), "gone");
        let ended = fault_of(r#"echo '{"slots":1}'; read a; echo 'out of ink' >&2"#);
        assert!(ended.ends_with("has ended: out of ink"), "{ended}");
        let refused = start(r#"echo '{"fault":"a: nobody answers"}'; read a"#, None).unwrap_err();
        assert_eq!((refused.code, refused.lines), ("cluster", vec!["a: nobody answers".to_owned()]));
        assert!(start("exit 1", None).is_err());
        assert_eq!(start(r#"echo '{"slots":0}'; read a"#, Some(7)).unwrap().at_once(), 7);
        assert_eq!(start(r#"echo '{"slots":0}'; read a"#, None).unwrap().at_once(), 1);
    }

    #[test]
    fn names_that_are_no_unicode_are_sent_as_bytes() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(name_value(OsStr::new("ä b")), json!("ä b"));
        assert_eq!(name_value(OsStr::from_bytes(b"a\xff")), json!([97, 255]));
    }
}
