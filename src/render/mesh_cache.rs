//! Meshes on the graphics card, uploaded once and kept as long as someone holds the CPU side.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use wgpu::util::DeviceExt as _;

use super::mesh::{RenderMesh, ValuePlace};
use super::scene::FieldLook;

/// Buffers of one mesh; `None` where there is nothing to draw.
#[derive(Debug)]
pub(super) struct GpuMesh {
    /// Three [`Corner`](super::mesh::Corner)s per triangle.
    pub(super) corners: Option<Counted>,
    /// Index pairs into the corners.
    pub(super) edges: Option<Counted>,
    /// One [`WideEdge`](super::mesh::WideEdge) per instance.
    pub(super) wide_edges: Option<Counted>,
    /// How many of them, at the start, are creases; the rest are borders.
    pub(super) n_features: u32,
    /// One [`Node`](super::mesh::Node) per instance.
    pub(super) nodes: Option<Counted>,
}

/// A buffer and the number of its elements.
#[derive(Debug)]
pub(super) struct Counted {
    pub(super) buffer: wgpu::Buffer,
    pub(super) count: u32,
}

impl Counted {
    fn new<T: bytemuck::NoUninit>(
        device: &wgpu::Device,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> Option<Self> {
        if data.is_empty() {
            return None;
        }
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("mesh"),
            contents: bytemuck::cast_slice(data),
            usage,
        });
        Some(Self {
            buffer,
            count: data.len() as u32,
        })
    }
}

impl GpuMesh {
    fn upload(device: &wgpu::Device, mesh: &RenderMesh) -> Self {
        let vertex = wgpu::BufferUsages::VERTEX;
        let mut edges = Counted::new(device, &mesh.edge_corners, wgpu::BufferUsages::INDEX);
        if let Some(edges) = &mut edges {
            edges.count *= 2;
        }
        Self {
            corners: Counted::new(device, &mesh.corners, vertex),
            edges,
            wide_edges: Counted::new(device, &mesh.wide_edges, vertex),
            n_features: mesh.n_feature_edges() as u32,
            nodes: Counted::new(device, &mesh.nodes, vertex),
        }
    }

    /// Where the values at the ends of creases and borders begin in the buffer of a field, in bytes.
    pub(super) fn ends_begin(&self) -> u64 {
        let corners = self.corners.as_ref().map_or(0, |corners| corners.count);
        size_of::<f32>() as u64 * u64::from(corners)
    }

    /// Where the values at the nodes begin.
    pub(super) fn nodes_begin(&self) -> u64 {
        let lines = self.wide_edges.as_ref().map_or(0, |wide| wide.count);
        self.ends_begin() + 2 * size_of::<f32>() as u64 * u64::from(lines)
    }
}

/// Values at every corner of a mesh, behind them those at both ends of its creases and borders, and behind these those
/// at its nodes. Larger than `NO_VALUE` of `common.wgsl` where there is none, because shaders may assume that NaN does
/// not happen.
fn field_of(mesh: &RenderMesh, field: &FieldLook) -> Vec<f32> {
    let value = |ValuePlace { vertex, corner }| {
        let at = if field.is_by_corner { corner } else { vertex };
        let value = field.values.get(at as usize).copied();
        value.filter(|value| value.is_finite()).unwrap_or(f32::MAX)
    };
    let corners = mesh.corner_vertices.iter().enumerate();
    let corners = corners.map(|(corner, &vertex)| {
        let source = mesh.source_corners.get(corner).copied();
        let corner = source.unwrap_or(corner as u32);
        ValuePlace { vertex, corner }
    });
    let ends = mesh.wide_ends.iter().flatten().copied();
    let nodes = mesh.node_places.iter().copied();
    corners.chain(ends).chain(nodes).map(value).collect()
}

/// An upload together with what keeps its key unique: as long as the weak reference lives, no other
/// allocation can have the same address.
#[derive(Debug)]
struct Kept<K: ?Sized, V> {
    key: Weak<K>,
    value: Arc<V>,
}

/// All uploads of one device.
#[derive(Debug, Default)]
pub(super) struct MeshCache {
    meshes: HashMap<usize, Kept<RenderMesh, GpuMesh>>,
    /// By address of mesh and values.
    fields: HashMap<(usize, usize), Kept<[f32], wgpu::Buffer>>,
    uploads: Uploads,
}

/// Uploads of large meshes and their fields, made off the frame.
#[derive(Debug, Default)]
struct Uploads {
    under_way: Vec<(usize, usize)>,
    done: Arc<Mutex<Vec<Upload>>>,
}

/// One of them; `None` where there is nothing to draw.
#[derive(Debug)]
enum Upload {
    Mesh(Arc<RenderMesh>, GpuMesh),
    Field(Arc<RenderMesh>, Arc<[f32]>, Option<wgpu::Buffer>),
}

impl Upload {
    /// Addresses of mesh and values; no values are at zero.
    fn key(&self) -> (usize, usize) {
        match self {
            Self::Mesh(mesh, _) => (address(mesh), 0),
            Self::Field(mesh, values, _) => (address(mesh), address(values)),
        }
    }
}

impl Uploads {
    fn lock(&self) -> MutexGuard<'_, Vec<Upload>> {
        // Only whole entries are added and taken.
        self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes one on a thread of its own unless it is under way; without a thread at once.
    fn start(
        &mut self,
        key: (usize, usize),
        make: impl FnOnce() -> Upload + Send + Clone + 'static,
    ) {
        if self.under_way.contains(&key) {
            return;
        }
        self.under_way.push(key);
        let (done, work) = (Arc::clone(&self.done), make.clone());
        let thread = std::thread::Builder::new().name("upload".to_owned());
        let started = thread.spawn(move || {
            let upload = work();
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            done.push(upload);
        });
        if started.is_err() {
            self.lock().push(make());
        }
    }
}

fn address<T: ?Sized>(shared: &Arc<T>) -> usize {
    Arc::as_ptr(shared).cast::<()>() as usize
}

impl MeshCache {
    /// The mesh's buffers, uploaded now if they are not there yet.
    pub(super) fn mesh(&mut self, device: &wgpu::Device, mesh: &Arc<RenderMesh>) -> Arc<GpuMesh> {
        let kept = self.meshes.entry(address(mesh)).or_insert_with(|| Kept {
            key: Arc::downgrade(mesh),
            value: Arc::new(GpuMesh::upload(device, mesh)),
        });
        Arc::clone(&kept.value)
    }

    /// The field's values by corner, by end of creases and borders, and by node; `None` for an empty mesh.
    pub(super) fn field(
        &mut self,
        device: &wgpu::Device,
        mesh: &Arc<RenderMesh>,
        field: &FieldLook,
    ) -> Option<Arc<wgpu::Buffer>> {
        let key = (address(mesh), address(&field.values));
        match self.fields.entry(key) {
            Entry::Occupied(kept) => Some(Arc::clone(&kept.get().value)),
            Entry::Vacant(free) => {
                let values = field_of(mesh, field);
                let counted = Counted::new(device, &values, wgpu::BufferUsages::VERTEX)?;
                let kept = free.insert(Kept {
                    key: Arc::downgrade(&field.values),
                    value: Arc::new(counted.buffer),
                });
                Some(Arc::clone(&kept.value))
            }
        }
    }

    /// True if the mesh and its field can be drawn without an upload; else the upload is under way and
    /// the answer is to be asked for again.
    pub(super) fn is_ready(
        &mut self,
        device: &wgpu::Device,
        mesh: &Arc<RenderMesh>,
        field: Option<&FieldLook>,
    ) -> bool {
        self.take_uploads();
        if !self.meshes.contains_key(&address(mesh)) {
            let (device, mesh) = (device.clone(), Arc::clone(mesh));
            self.uploads.start((address(&mesh), 0), move || {
                let made = GpuMesh::upload(&device, &mesh);
                Upload::Mesh(mesh, made)
            });
            return false;
        }
        let Some(field) = field else { return true };
        let key = (address(mesh), address(&field.values));
        if !self.fields.contains_key(&key) && !mesh.corner_vertices.is_empty() {
            let (device, mesh, field) = (device.clone(), Arc::clone(mesh), field.clone());
            self.uploads.start(key, move || {
                let values = field_of(&mesh, &field);
                let made = Counted::new(&device, &values, wgpu::BufferUsages::VERTEX);
                Upload::Field(mesh, field.values, made.map(|made| made.buffer))
            });
            return false;
        }
        true
    }

    fn take_uploads(&mut self) {
        let done = std::mem::take(&mut *self.uploads.lock());
        for upload in done {
            let key = upload.key();
            self.uploads.under_way.retain(|other| *other != key);
            match upload {
                Upload::Mesh(mesh, value) => {
                    self.meshes.entry(key.0).or_insert_with(|| Kept {
                        key: Arc::downgrade(&mesh),
                        value: Arc::new(value),
                    });
                }
                Upload::Field(_, values, Some(buffer)) => {
                    self.fields.entry(key).or_insert_with(|| Kept {
                        key: Arc::downgrade(&values),
                        value: Arc::new(buffer),
                    });
                }
                Upload::Field(_, _, None) => {}
            }
        }
    }

    /// Frees what nobody holds any more.
    pub(super) fn sweep(&mut self) {
        self.meshes.retain(|_, kept| kept.key.strong_count() > 0);
        let meshes = &self.meshes;
        self.fields
            .retain(|key, kept| kept.key.strong_count() > 0 && meshes.contains_key(&key.0));
    }

    /// Number of meshes on the graphics card.
    pub(super) fn n_meshes(&self) -> usize {
        self.meshes.len()
    }
}
