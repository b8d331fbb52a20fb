//! Plain data for one frame. Two equal scenes give the same picture, which is how a viewport knows
//! that it need not draw again; meshes and fields are compared by identity.

use std::sync::Arc;

use super::mesh::RenderMesh;
use crate::colormap::{ColorScale, Rgb};
use crate::geometry::{Aabb, Point3, Similarity, Vector3};
use crate::palette::{DARK_GROUND, LIGHT_GROUND};

/// An sRGB colour with opacity (not premultiplied), a byte per channel.
pub type Rgba = [u8; 4];

/// Everything in one picture except the camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Meshes, in any order.
    pub drawables: Vec<Drawable>,
    /// Lines and fills on top of them.
    pub overlay: Overlay,
    /// What is behind everything.
    pub background: Background,
    /// Colours and widths of mesh lines.
    pub lines: LineLook,
    /// Cuts away one side of a plane.
    pub section: Option<Section>,
    /// Place of the wipe line as a share of the picture's width; see [`Drawable::wipe`].
    pub wipe: Option<f32>,
    /// Where solid meshes of the two [`Sheet`]s lie closer together than this, both are drawn in stripes
    /// of their two colours. World units.
    pub coincidence: Option<f64>,
    /// Brightness of the light on surfaces; zero counts as one. More than one suits dark colours on a
    /// light ground.
    pub exposure: f32,
    /// Share of the light that comes from everywhere, 0 … 1: the more, the truer the parts' colours and
    /// the flatter their shapes.
    pub ambient: f32,
    /// Pixels per point of the screen; widths and sizes are in points. Zero counts as one.
    pub pixels_per_point: f32,
}

impl Scene {
    /// World box around all drawables and the overlay's points.
    pub fn bounds(&self) -> Aabb {
        let mut bounds = Aabb::empty();
        for drawable in &self.drawables {
            bounds = bounds.union(&drawable.bounds());
        }
        for point in self.overlay.points() {
            bounds.insert(point);
        }
        bounds
    }

    /// True if everything lies as in another scene: only looks may differ.
    pub(super) fn lies_as(&self, other: &Self) -> bool {
        let pairs = self.drawables.iter().zip(&other.drawables);
        self.drawables.len() == other.drawables.len()
            && self.wipe == other.wipe
            && self.section == other.section
            && pairs.into_iter().all(|(a, b)| a.lies_as(b))
    }

    /// The exposure, one if it was not given.
    pub(super) fn exposure(&self) -> f32 {
        if self.exposure > 0.0 {
            self.exposure
        } else {
            1.0
        }
    }

    /// The sheets of which something solid is drawn, each with its colour, if both are there and may
    /// coincide.
    pub fn coinciding(&self) -> Option<[Rgb; 2]> {
        self.coincidence.filter(|distance| *distance > 0.0)?;
        let of = |sheet| self.drawables.iter().find(|d| d.is_solid_of(sheet));
        Some([of(Sheet::First)?.color, of(Sheet::Second)?.color])
    }

    /// Pixels per point, at least a little more than nothing.
    pub(super) fn scale_factor(&self) -> f32 {
        if self.pixels_per_point > 0.0 {
            self.pixels_per_point
        } else {
            1.0
        }
    }
}

/// The area behind the parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// A vertical gradient.
    Gradient {
        /// Colour of the upper edge.
        top: Rgb,
        /// Colour of the lower edge.
        bottom: Rgb,
    },
    /// Nothing, for pictures that go on paper.
    Transparent,
}

impl Background {
    /// The dark theme's gradient about #1E2126.
    pub const DARK: Self = Self::Gradient {
        top: DARK_GROUND[0],
        bottom: DARK_GROUND[1],
    };
    /// The light theme's gradient about #ECEEF1.
    pub const LIGHT: Self = Self::Gradient {
        top: LIGHT_GROUND[0],
        bottom: LIGHT_GROUND[1],
    };
}

impl Default for Background {
    fn default() -> Self {
        Self::DARK
    }
}

/// Lines that belong to meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineLook {
    /// Edges of elements, one pixel wide; they fade out where they would fill the picture.
    pub edge: Rgba,
    /// Creases.
    pub feature: Rgba,
    /// Borders and holes.
    pub border: Rgba,
    /// Width of creases in points.
    pub feature_width: f32,
    /// Width of borders in points.
    pub border_width: f32,
    /// Diameter of nodes in points.
    pub point_size: f32,
    /// Colour of the outline around selected parts; its rim is the opposite lightness.
    pub selection: Rgb,
}

impl LineLook {
    /// For dark backgrounds.
    pub const DARK: Self = Self {
        edge: [10, 14, 20, 120],
        feature: [10, 14, 20, 150],
        border: [8, 10, 14, 235],
        feature_width: 1.1,
        border_width: 1.7,
        point_size: 4.0,
        selection: [255, 255, 255],
    };
    /// For light backgrounds.
    pub const LIGHT: Self = Self {
        edge: [40, 46, 54, 110],
        feature: [48, 52, 58, 150],
        border: [48, 52, 58, 235],
        border_width: 1.5,
        selection: [0, 0, 0],
        ..Self::DARK
    };
}

impl Default for LineLook {
    fn default() -> Self {
        Self::DARK
    }
}

/// A cutting plane; what lies on the side of the normal is not drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// A point of the plane.
    pub point: Point3,
    /// Direction to the side that is cut away; any length but zero.
    pub normal: Vector3,
}

/// On which side of the wipe line something is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WipeSide {
    /// On both sides of the line.
    #[default]
    Both,
    /// Only left of it.
    Left,
    /// Only right of it.
    Right,
}

/// Of two sheets that may lie in each other, the one a mesh belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sheet {
    /// The sheet that takes the even stripes.
    First,
    /// The sheet that takes the odd stripes.
    Second,
}

impl Sheet {
    /// Both.
    pub(super) const ALL: [Self; 2] = [Self::First, Self::Second];

    /// The other one.
    pub(super) fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

/// One mesh in the picture.
#[derive(Debug, Clone)]
pub struct Drawable {
    /// The prepared mesh.
    pub mesh: Arc<RenderMesh>,
    /// Pose of the mesh in the scene.
    pub world_from_mesh: Similarity,
    /// A shift for display only, in world units (separation).
    pub offset: Vector3,
    /// Colour of parts without one of their own.
    pub color: Rgb,
    /// 0 invisible … 1 solid.
    pub opacity: f32,
    /// Looks of the parts by part index of the mesh; parts beyond the end look plain. `None`: all plain.
    pub parts: Option<Arc<[PartLook]>>,
    /// Values shown as colours instead.
    pub field: Option<FieldLook>,
    /// What is drawn of the mesh.
    pub style: Style,
    /// Pushes the mesh away from the viewer by so many pixels of world length: of two coincident
    /// sheets, the one with the smaller value wins everywhere.
    pub push_back: f32,
    /// The same in world units, added to it. Two meshes of one curved sheet cut through each other by
    /// their chord heights, about element size² / (4 · radius), at any zoom.
    pub push_back_length: f64,
    /// The sheet it belongs to, for [`Scene::coincidence`].
    pub sheet: Option<Sheet>,
    /// Side of the wipe line.
    pub wipe: WipeSide,
}

impl Drawable {
    /// A solid mesh in its own coordinates, plain, with borders and creases.
    pub fn new(mesh: Arc<RenderMesh>, color: Rgb) -> Self {
        Self {
            mesh,
            world_from_mesh: Similarity::identity(),
            offset: Vector3::zeros(),
            color,
            opacity: 1.0,
            parts: None,
            field: None,
            style: Style::default(),
            push_back: 0.0,
            push_back_length: 0.0,
            sheet: None,
            wipe: WipeSide::Both,
        }
    }

    /// World box of the mesh, hidden parts included.
    pub fn bounds(&self) -> Aabb {
        let bounds = self.mesh.bounds();
        if bounds.is_empty() {
            return bounds;
        }
        let corners = bounds
            .corners()
            .map(|corner| self.world_from_mesh.apply(&corner) + self.offset);
        Aabb::of_points(&corners)
    }

    /// True if it is the same mesh at the same place, whatever it looks like.
    fn lies_as(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.world_from_mesh == other.world_from_mesh
            && self.offset == other.offset
            && self.style.surface == other.style.surface
    }

    /// True if it hides what lies behind it and belongs to a sheet.
    pub(super) fn is_solid_of(&self, sheet: Sheet) -> bool {
        self.sheet == Some(sheet) && self.opacity >= 1.0 && self.style.surface
    }

    /// True if something is selected, so that an outline is needed.
    pub(super) fn has_selection(&self) -> bool {
        self.parts.iter().flat_map(|p| p.iter()).any(|p| p.selected)
    }
}

impl PartialEq for Drawable {
    fn eq(&self, other: &Self) -> bool {
        let parts_equal = match (&self.parts, &other.parts) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            (None, None) => true,
            _ => false,
        };
        parts_equal
            && Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.world_from_mesh == other.world_from_mesh
            && self.offset == other.offset
            && self.color == other.color
            && self.opacity == other.opacity
            && self.field == other.field
            && self.style == other.style
            && self.push_back == other.push_back
            && self.push_back_length == other.push_back_length
            && self.sheet == other.sheet
            && self.wipe == other.wipe
    }
}

/// Look of one part of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartLook {
    /// Its colour; `None` for the drawable's.
    pub color: Option<Rgb>,
    /// False hides it.
    pub visible: bool,
    /// Draws the selection outline around it.
    pub selected: bool,
    /// Lightens it, as under the mouse.
    pub hovered: bool,
}

impl Default for PartLook {
    fn default() -> Self {
        Self {
            color: None,
            visible: true,
            selected: false,
            hovered: false,
        }
    }
}

/// One number per mesh vertex, or per corner of the triangles, shown as colour.
#[derive(Debug, Clone)]
pub struct FieldLook {
    /// Values by vertex of the mesh the [`RenderMesh`] was made of; NaN where there is none, which is
    /// drawn grey with a hatch. Missing values at the end count as NaN.
    pub values: Arc<[f32]>,
    /// The values stand at the corners of the triangles instead, three for each, so that neighbours
    /// may differ at their common edge.
    pub is_by_corner: bool,
    /// Colours of the values.
    pub scale: ColorScale,
}

impl PartialEq for FieldLook {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.values, &other.values) && self.scale == other.scale
    }
}

/// What is drawn of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// The triangles. Without them lines are drawn in the mesh's own colour.
    pub surface: bool,
    /// Edges of elements.
    pub element_edges: bool,
    /// Creases: lines along which the sheet clearly turns by more than 25°, short ones only above 50°.
    pub feature_edges: bool,
    /// Borders and holes.
    pub borders: bool,
    /// Nodes.
    pub points: bool,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            surface: true,
            element_edges: false,
            feature_edges: true,
            borders: true,
            points: false,
        }
    }
}

/// How an overlay meets the parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthMode {
    /// Drawn over everything.
    OnTop,
    /// Fully visible in front, faint behind.
    #[default]
    Faint,
}

/// Things that are not meshes. Positions are world coordinates, widths points on the screen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overlay {
    /// Lines.
    pub polylines: Vec<Polyline>,
    /// Plain triangles, both sides visible.
    pub fills: Vec<Fill>,
}

impl Overlay {
    fn points(&self) -> impl Iterator<Item = &Point3> {
        let lines = self.polylines.iter().flat_map(|line| &line.points);
        let fills = self
            .fills
            .iter()
            .flat_map(|fill| fill.triangles.iter().flatten());
        lines.chain(fills)
    }
}

/// A line through points.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// The points; fewer than two draw nothing.
    pub points: Vec<Point3>,
    /// Colour and opacity.
    pub color: Rgba,
    /// Width in points.
    pub width: f32,
    /// Length of dashes and of the gaps between them in points; 0 for a solid line.
    pub dash: f32,
    /// How it meets the parts.
    pub depth: DepthMode,
}

impl Polyline {
    /// A solid line that shines faintly through parts.
    pub fn new(points: Vec<Point3>, color: Rgba, width: f32) -> Self {
        Self {
            points,
            color,
            width,
            dash: 0.0,
            depth: DepthMode::default(),
        }
    }
}

/// Triangles of one colour, without light.
#[derive(Debug, Clone, PartialEq)]
pub struct Fill {
    /// Corners of each triangle.
    pub triangles: Vec<[Point3; 3]>,
    /// Colour and opacity.
    pub color: Rgba,
    /// How it meets the parts.
    pub depth: DepthMode,
}
