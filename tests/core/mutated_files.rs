//! Damaged files of every kind: none panics, hangs, takes memory without end or ends the process.
//!
//! Seeded, so that a file that fails comes again. `SHAPEMATCH_MUTATED_FILES=100000` reads that many
//! in place of the few of an ordinary run; `SHAPEMATCH_MUTATION_SEED` begins elsewhere.

use std::path::Path;
use std::sync::mpsc;
use std::time::Duration;

use shapematch::formats::{self, FormatError, Memory, ReadOptions, Selection, obj, ply, stl};
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;

use super::mesh_files::ascii_stl;

/// A file of some kilobytes that is not read after this time hangs.
const PATIENCE: Duration = Duration::from_secs(60);
/// Kilobytes of address space for one file, hundreds of times what any of them needs.
#[cfg(unix)]
const MAX_KILOBYTES: usize = 4 << 20;

/// What breaks readers: numbers at the edge, signs with a meaning, keywords that name more.
const WORDS: &[&[u8]] = &[
    b"1e999",
    b"-1e308",
    b"nan",
    b"99999999999999999999",
    b"-1",
    b"0",
    b"4294967295",
    b"10000",
    b"*",
    b"$",
    b"&",
    b"<",
    b",",
    b"\t",
    b"\r",
    b"\n",
    b"\0",
    b"\xff\xfe",
    b"\x1f\x8b",
    b"\\",
    b"\n*INCLUDE\nmain.k\n",
    b"\n*SET_NODE_ADD\n1\n1\n",
    b"\n*SET_NODE_GENERAL\n2\nALL\n",
    b"\n*SET_NODE_LIST_GENERATE\n3\n1,999999999999\n",
    b"\n*KEYWORD LONG=Y\n",
    b"\n*ELEMENT_SHELL_COMPOSITE\n",
    b"\n*INITIAL_STRESS_SHELL\n1,10000,10000,10000\n",
    b"\n*PARAMETER\nRx,<x*x>\n",
    b"\nf 1 2 3 4 5 -1\n",
    b"\nelement face 999999\n",
    b"solid ",
];

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Whole files of every kind.
fn corpus() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/keyword");
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "k" || e == "gz"))
        .map(|path| ("main.k".to_owned(), std::fs::read(path).unwrap()))
        .collect();
    files.sort();
    let corner = |i: u32| Point3::new(f64::from(i), f64::from(i % 3), 0.5);
    let triangles = (0..8).map(|i| [i, i + 1, i + 2]).collect();
    let mesh = TriMesh::new((0..10).map(corner).collect(), triangles).unwrap();
    let strips = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n4 0 1 2 -1\n";
    files.push(("main.stl".to_owned(), stl::write_binary(&mesh)));
    files.push(("main.stl".to_owned(), ascii_stl(&mesh, "x")));
    files.push(("main.obj".to_owned(), obj::write(&mesh, "x")));
    files.push(("main.ply".to_owned(), ply::write(&mesh, "x")));
    files.push(("main.ply".to_owned(), strips.as_bytes().to_vec()));
    files
}

/// One file of the corpus with a few faults.
fn mutated(corpus: &[(String, Vec<u8>)], random: &mut Random) -> (String, Vec<u8>) {
    let (name, mut bytes) = corpus[random.below(corpus.len())].clone();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = (at + random.below(40)).min(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let times = 1 + random.below(50);
                bytes.splice(at..at, piece.repeat(times));
            }
            3 => {
                let other = &corpus[random.below(corpus.len())].1;
                let from = random.below(other.len());
                bytes.splice(at..end, other[from..].iter().copied());
            }
            4 | 5 => {
                let word = WORDS[random.below(WORDS.len())];
                bytes.splice(at..end, word.iter().copied());
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = random.next() as u8;
                }
            }
        }
    }
    (name, bytes)
}

fn of_environment(name: &str, usual: u64) -> u64 {
    let value = std::env::var(name).ok();
    value.and_then(|text| text.parse().ok()).unwrap_or(usual)
}

fn first_seed() -> u64 {
    of_environment("SHAPEMATCH_MUTATION_SEED", 1)
}

/// Reads a file and does with it what the program does; a limit ends the reading.
fn read(name: &str, bytes: Vec<u8>, monitor: &Monitor) -> Result<(), FormatError> {
    let options = ReadOptions {
        max_bytes: 1 << 26,
        max_files: 200,
        max_set_ids: 1 << 20,
        ..ReadOptions::default()
    };
    let files = Memory::new().with(name, bytes);
    let model = formats::read_from(&files, Path::new(name), &options, monitor)?;
    let _ = model.part_summaries();
    if let Ok(surface) = model.surface(&Selection::All) {
        let places = surface.mesh.positions();
        assert!(places.iter().all(|p| p.iter().all(|x| x.is_finite())));
    }
    Ok(())
}

#[test]
fn no_damaged_file_panics_or_hangs() {
    let corpus = corpus();
    let n = of_environment("SHAPEMATCH_MUTATED_FILES", 3_000);
    for seed in first_seed()..first_seed() + n {
        let (name, bytes) = mutated(&corpus, &mut Random(seed));
        let monitor = Monitor::silent();
        let (done, is_done) = mpsc::channel::<()>();
        let watched = &monitor;
        let result = std::thread::scope(|scope| {
            scope.spawn(move || {
                if is_done.recv_timeout(PATIENCE) == Err(mpsc::RecvTimeoutError::Timeout) {
                    watched.request_cancel();
                }
            });
            // The sender is dropped with the closure's end, also by a panic.
            let _done = done;
            std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                read(&name, bytes, &monitor)
            }))
        });
        match result {
            Err(_) => panic!("SHAPEMATCH_MUTATION_SEED={seed} panics: {name}"),
            Ok(Err(FormatError::Cancelled(_))) => {
                panic!("SHAPEMATCH_MUTATION_SEED={seed} hangs: {name}")
            }
            Ok(_) => {}
        }
    }
}

/// Through the whole program, one process for each file, with little memory: an allocation that
/// fails, a full stack and a bus error end a process and cannot be caught within it.
#[cfg(unix)]
#[test]
fn no_damaged_file_ends_the_process() {
    let folder = tempfile::tempdir().unwrap();
    let corpus = corpus();
    let n = of_environment("SHAPEMATCH_MUTATED_FILES", 3_000) / 60;
    for seed in first_seed()..first_seed() + n {
        let (name, bytes) = mutated(&corpus, &mut Random(seed));
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let status = std::process::Command::new("sh")
            .arg("-c")
            .arg(format!(
                "ulimit -v {MAX_KILOBYTES}; exec \"$0\" info \"$1\""
            ))
            .arg(env!("CARGO_BIN_EXE_shapematch"))
            .arg(&path)
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .status()
            .unwrap();
        let code = status.code();
        assert!(
            matches!(code, Some(0 | 1)),
            "SHAPEMATCH_MUTATION_SEED={seed}: {status}"
        );
    }
}
