//! The program: arguments in, exit code out.

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use shapematch::cli::{self, Cli};
use shapematch::text::without_error_number;

fn main() -> ExitCode {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    give_memory_back();
    let first = std::env::args_os().nth(1);
    cli::refuse_unknown(first.as_deref());
    let cli = Cli::parse();
    cli::refuse_window_options(&cli);
    // It may stand behind options.
    cli::refuse_unknown(cli.files.first().map(|file| file.as_os_str()));
    start_logging(cli.quiet);
    #[cfg(unix)]
    if let Err(error) = shapematch::pipeline::write_file::clean_up_on_signals() {
        log::warn!("half-written files will stay where the program is interrupted: {error}");
    }
    if let Err(error) = threads(&cli).build_global() {
        log::warn!("the number of threads could not be set: {error}");
    }
    let outcome = match &cli.command {
        Some(task) => cli::run(task, cli.quiet),
        None => open_window(&cli),
    };
    outcome.unwrap_or_else(|error| {
        log::error!("{}", without_error_number(&format!("{error:#}")));
        cli::exit_status(&error)
    })
}

/// Has glibc give freed memory back to the system. By itself it raises both limits to what was freed last, and then
/// keeps up to 64 MB for every thread: 0.14 of 0.91 GB with a pair of 3.6M triangles.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[expect(
    unsafe_code,
    reason = "the only way to the allocator's limits, and safe while no other thread runs"
)]
fn give_memory_back() {
    // Blocks from here on are mapped each by itself, and unmapped when they are freed.
    const MAPPED_FROM: libc::c_int = 4 << 20;
    // What is kept at the end of a heap.
    const KEPT: libc::c_int = 8 << 20;
    // SAFETY: `mallopt` takes numbers and no pointers; what it refuses stays as it was.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, MAPPED_FROM);
        libc::mallopt(libc::M_TOP_PAD, KEPT);
    }
}

/// The threads of the work; those of a window stand behind it.
fn threads(cli: &Cli) -> rayon::ThreadPoolBuilder {
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(cli.n_threads(n_cores));
    #[cfg(feature = "gui")]
    if cli.command.is_none() {
        return threads.start_handler(|_| shapematch::ui::step_back());
    }
    threads
}

/// Messages go to standard error; `RUST_LOG` says more.
fn start_logging(quiet: bool) {
    let level = if quiet { "error" } else { "warn" };
    // Why the window does not open is told once, by us.
    let filter = format!("{level},winit=error,eframe=off,wgpu_hal::vulkan::instance=off");
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or(filter))
        .format(|line, record| {
            let text = record.args().to_string();
            writeln!(line, "[{:<5}] {}", record.level(), cli::printable(&text))
        })
        .init();
}

/// Opens the window with what was named.
#[cfg(feature = "gui")]
fn open_window(cli: &Cli) -> anyhow::Result<ExitCode> {
    let mut files = cli.files.iter().cloned();
    shapematch::ui::run(shapematch::app::StartupOptions {
        crash: files.next(),
        stamped: files.next(),
        example: cli.example,
        realistic: cli.realistic,
        forget_settings: false,
    })
}

/// This build has no window: says so and shows the help.
#[cfg(not(feature = "gui"))]
fn open_window(_cli: &Cli) -> anyhow::Result<ExitCode> {
    use clap::CommandFactory as _;
    Cli::command().print_help()?;
    anyhow::bail!("this build has no window; name a subcommand")
}
