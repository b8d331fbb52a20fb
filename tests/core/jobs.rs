//! The worker: what it answers, in which order, and that nothing runs on after stop and cancel.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use shapematch::jobs::{
    Destination, ExportRequest, Exported, JobError, JobEvent, JobKey, JobKind, JobOutput, JobStage,
    Stamp, Worker,
};
use shapematch::monitor::Monitor;
use shapematch::pipeline::outputs::{Output, OutputInput};

const PATIENCE: Duration = Duration::from_secs(30);
/// The place of [`export`] in the queue.
const EXPORT: JobKey = JobKey::Export(1);

fn export() -> JobKind {
    JobKind::Export(ExportRequest {
        number: 1,
        to: Destination::File("nowhere.txt".into()),
        output: Output::Log,
        input: OutputInput::default(),
    })
}

fn other_kind() -> JobKind {
    let source = shapematch::jobs::PartSource::Example;
    JobKind::Load {
        role: shapematch::role::Role::Crash,
        source,
        settings: shapematch::pipeline::load::LoadSettings::default(),
    }
}

fn nothing() -> JobOutput {
    JobOutput::Exported(Exported {
        to: Destination::Clipboard("Nothing".to_owned()),
        text: None,
        notes: Vec::new(),
    })
}

fn spawn(
    runner: impl FnMut(JobKind, &Monitor) -> Result<JobOutput, JobError> + Send + 'static,
) -> (Worker, Arc<AtomicUsize>) {
    let n_wakes = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&n_wakes);
    let wake = move || {
        counter.fetch_add(1, Ordering::SeqCst);
    };
    (Worker::spawn(runner, Arc::new(wake)).unwrap(), n_wakes)
}

fn next(worker: &Worker) -> JobEvent {
    worker.wait_event(PATIENCE).expect("an event comes")
}

/// A job of chunks: each says that it began and waits until it may go on.
struct Chunks {
    begun: Receiver<usize>,
    go_on: Sender<()>,
    worker: Worker,
}

fn chunked(keeps_best: bool) -> Chunks {
    let (tell, begun) = channel();
    let (go_on, wait) = channel::<()>();
    let wait = Mutex::new(wait);
    let (worker, _) = spawn(move |_kind: JobKind, monitor: &Monitor| {
        for chunk in 0..1000 {
            monitor.check()?;
            if keeps_best && monitor.stop_requested() {
                return Ok(nothing());
            }
            tell.send(chunk).unwrap();
            let _ = wait.lock().unwrap().recv();
        }
        Ok(nothing())
    });
    Chunks {
        begun,
        go_on,
        worker,
    }
}

#[test]
fn no_second_chunk_starts_after_cancel() {
    let job = chunked(false);
    job.worker.submit(export(), Stamp::default());
    assert_eq!(job.begun.recv_timeout(PATIENCE).unwrap(), 0);
    job.worker.cancel(EXPORT);
    job.go_on.send(()).unwrap();
    assert!(matches!(next(&job.worker).stage, JobStage::Started));
    assert!(matches!(next(&job.worker).stage, JobStage::Cancelled));
    assert!(job.begun.try_recv().is_err(), "a second chunk began");
    assert!(job.worker.is_idle());
}

#[test]
fn no_second_chunk_starts_after_stop_and_the_best_is_kept() {
    let job = chunked(true);
    job.worker.submit(export(), Stamp::default());
    assert_eq!(job.begun.recv_timeout(PATIENCE).unwrap(), 0);
    job.worker.stop(EXPORT);
    job.go_on.send(()).unwrap();
    assert!(matches!(next(&job.worker).stage, JobStage::Started));
    assert!(matches!(next(&job.worker).stage, JobStage::Finished(_)));
    assert!(job.begun.try_recv().is_err(), "a second chunk began");
}

#[test]
fn a_newer_request_replaces_the_waiting_one_only() {
    let job = chunked(false);
    let first = job.worker.submit(export(), Stamp::default());
    job.begun.recv_timeout(PATIENCE).unwrap();
    let waiting = job.worker.submit(export(), Stamp::default());
    let other = job.worker.submit(other_kind(), Stamp::default());
    let newer = job.worker.submit(export(), Stamp::default());
    assert_eq!(next(&job.worker).id, first);
    let replaced = next(&job.worker);
    assert_eq!(replaced.id, waiting);
    assert!(matches!(replaced.stage, JobStage::Cancelled));
    assert_eq!(job.worker.running(), Some(EXPORT));
    job.worker.cancel_all();
    job.go_on.send(()).unwrap();
    let mut ended: Vec<_> = (0..3).map(|_| next(&job.worker)).collect();
    ended.sort_by_key(|event| event.id);
    let ids: Vec<_> = ended.iter().map(|event| event.id).collect();
    assert_eq!(ids, [first, other, newer]);
    let are_cancelled = |e: &JobEvent| matches!(e.stage, JobStage::Cancelled);
    assert!(ended.iter().all(are_cancelled));
}

#[test]
fn a_panic_is_a_failed_job_and_the_worker_goes_on() {
    let mut n_jobs = 0;
    let (worker, n_wakes) = spawn(move |_kind: JobKind, _: &Monitor| {
        n_jobs += 1;
        assert!(n_jobs > 1, "a broken invariant");
        Ok(nothing())
    });
    let stamp = Stamp {
        pose: 7,
        ..Stamp::default()
    };
    worker.submit(export(), stamp);
    assert!(matches!(next(&worker).stage, JobStage::Started));
    let failed = next(&worker);
    assert_eq!(failed.stamp, stamp);
    match failed.stage {
        JobStage::Failed(message) => {
            assert_eq!(message, "internal error: a broken invariant");
        }
        other => panic!("{other:?}"),
    }
    worker.submit(export(), stamp);
    assert!(matches!(next(&worker).stage, JobStage::Started));
    assert!(matches!(next(&worker).stage, JobStage::Finished(_)));
    assert!(n_wakes.load(Ordering::SeqCst) >= 3);
}

#[test]
fn progress_is_seen_while_the_job_runs_and_what_it_told_last_after_it() {
    let (tell, told) = channel();
    let (go_on, wait) = channel::<()>();
    let wait = Mutex::new(wait);
    let (worker, _) = spawn(move |_kind: JobKind, monitor: &Monitor| {
        monitor.progress("count", 3, Some(9));
        tell.send(()).unwrap();
        let _ = wait.lock().unwrap().recv();
        Ok(nothing())
    });
    let id = worker.submit(export(), Stamp::default());
    told.recv_timeout(PATIENCE).unwrap();
    let live = worker.live();
    assert_eq!(live.job, Some(id));
    assert_eq!(live.progress.map(|p| (p.done, p.total)), Some((3, Some(9))));
    go_on.send(()).unwrap();
    assert!(matches!(next(&worker).stage, JobStage::Started));
    assert!(matches!(next(&worker).stage, JobStage::Finished(_)));
    assert_eq!(worker.live().job, Some(id));
    assert_eq!(worker.live().progress.map(|p| p.done), Some(3));
}

#[test]
fn dropping_the_worker_ends_a_running_job() {
    let (tell, told) = channel();
    let (worker, _) = spawn(move |_kind: JobKind, monitor: &Monitor| {
        tell.send(()).unwrap();
        loop {
            monitor.check()?;
            std::thread::yield_now();
        }
    });
    worker.submit(export(), Stamp::default());
    told.recv_timeout(PATIENCE).unwrap();
    drop(worker);
}
