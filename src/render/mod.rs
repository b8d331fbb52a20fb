//! Pictures of meshes: a [`Scene`] and a camera in, a texture or an image out. Knows geometry and
//! colours, and neither the window nor the program's state.
//!
//! A mesh is prepared once on the CPU ([`RenderMesh`], in a job), uploaded once ([`Renderer`] keeps
//! it as long as someone holds it), and drawn into the multisampled textures of one viewport
//! ([`ViewTarget`]), again only if something changed. Where that would take long, the window asks for
//! it in steps ([`Renderer::draw_step`]): a coarse picture while the view moves, the exact one at rest.
//! Depth is a 32-bit float, 1 near and 0 far. Colours are blended in sRGB, which is what the target holds.
//! Nothing beyond the default features of wgpu is used, and of its limits only larger buffers for large
//! meshes, so that software drivers and OpenGL draw the same picture.

mod coarse;
mod context;
mod frame;
mod mesh;
mod mesh_build;
mod mesh_cache;
mod pass;
mod pipeline;
mod prepare;
mod prepare_overlay;
mod readback;
mod renderer;
mod scene;
mod sheets;
mod slice;
mod steps;
mod target;
mod texture;
mod uniforms;

pub use coarse::{COARSE, COARSE_ON_PROCESSOR};
pub use frame::Frame;
pub use mesh::{MeshInput, RenderMesh};
pub use readback::ReadbackError;
pub use renderer::Renderer;
pub use scene::{
    Background, DepthMode, Drawable, FieldLook, Fill, LineLook, Overlay, PartLook, Polyline, Rgba,
    Scene, Section, Sheet, Style, WipeSide,
};
pub use steps::Drawn;
pub use target::ViewTarget;
