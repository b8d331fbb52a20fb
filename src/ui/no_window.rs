//! What is said where no window can be opened: why, which adapters there are, and what to do.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// The error of the window in plain words.
pub(super) fn explained(error: &eframe::Error) -> anyhow::Error {
    anyhow::anyhow!(
        "the window could not be opened: {}\n\
         Graphics adapters found: {}\n\
         The window needs a display and a graphics adapter for Vulkan, Metal, DirectX 12 or OpenGL; a \
         software one such as Mesa's llvmpipe will do. WGPU_BACKEND=vulkan, gl, metal or dx12 chooses.\n\
         Everything but the window works without: see shapematch --help",
        reason(&error.to_string()),
        adapters()
    )
}

/// The reason without places in source files, which help nobody.
fn reason(text: &str) -> &str {
    let after = |mark| text.rsplit_once(mark).map(|(_, rest)| rest);
    let in_source = after(".rs:").and_then(|rest| Some(rest.split_once(": ")?.1));
    in_source.unwrap_or(text)
}

/// All adapters of all kinds, whatever was chosen.
fn adapters() -> String {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    // On a desktop the answer is there at once.
    let listing = pin!(instance.enumerate_adapters(wgpu::Backends::all()));
    let Poll::Ready(found) = listing.poll(&mut Context::from_waker(Waker::noop())) else {
        return "unknown".to_owned();
    };
    let names = found.iter().map(|adapter| {
        let info = adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    });
    let names: Vec<String> = names.collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::reason;

    #[test]
    fn reasons_name_no_source_files() {
        let text = "winit EventLoopError: os error at /x/winit/mod.rs:765: DISPLAY is not set.";
        assert_eq!(reason(text), "DISPLAY is not set.");
        assert_eq!(reason("WGPU error: none"), "WGPU error: none");
    }
}
