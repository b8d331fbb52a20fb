// What every shader shares: the uniforms, the way from view space to the screen, and sRGB.
// View space is centred at the camera's target, x right, y up, z towards the viewer.
//
// What a vertex shader calls must not branch on uniforms alone: Mesa's software driver then puts their
// values into the code and compiles the shader anew whenever a uniform changes, with every step of the
// camera. Choose with select(), and join conditions with | and &, which are no branches.

struct Frame {
    clip_from_view: mat4x4<f32>,
    // Distance of the eye, 1 for perspective, world length of a pixel at the target, pixels per point.
    eye: vec4<f32>,
    // Width and height of the picture in pixels, 0, 0.
    screen: vec4<f32>,
    // Plane in view space: kept where dot(xyz, p) + w <= 0.
    section: vec4<f32>,
    // 1 if the section cuts, pixel of the wipe line (negative: none), exposure, distance within which
    // two sheets coincide.
    switches: vec4<f32>,
    background_top: vec4<f32>,
    background_bottom: vec4<f32>,
    edge_color: vec4<f32>,
    feature_color: vec4<f32>,
    border_color: vec4<f32>,
    selection_color: vec4<f32>,
    // Where a field has no value.
    unmatched_color: vec4<f32>,
    // Widths of creases and borders and the diameter of nodes, in pixels; share of ambient light.
    widths: vec4<f32>,
}

struct Drawable {
    view_from_mesh: mat4x4<f32>,
    // sRGB colour and opacity.
    color: vec4<f32>,
    // Colour of the sheet it may coincide with, strength of the hatch on back sides.
    other_sheet: vec4<f32>,
    // Field value at the start of the table, one over the range, pixels pushed back, edge opacity.
    params: vec4<f32>,
    // Switches (below), width of the parts table, 0, 0.
    flags: vec4<u32>,
}

const HAS_FIELD: u32 = 1u;
const MIRRORED: u32 = 2u;
const WIPE_LEFT: u32 = 4u;
const WIPE_RIGHT: u32 = 8u;
const FIRST_SHEET: u32 = 16u;
const SECOND_SHEET: u32 = 32u;
const BARE: u32 = 64u;
const HIDES_BEYOND: u32 = 128u;

// Larger field values mean that there is none.
const NO_VALUE: f32 = 1e37;
// Values are beyond the ends of the table from here on, as a share of it: the ends themselves are not.
const BEYOND: f32 = 1e-5;

// Bits of a part's look in the parts table.
const PART_VISIBLE: u32 = 1u;
const PART_SELECTED: u32 = 2u;
const PART_HOVERED: u32 = 4u;
const PART_COLORED: u32 = 8u;
const PARTS_PER_ROW: u32 = 256u;

@group(0) @binding(0) var<uniform> frame: Frame;
// Depths of the two sheets in view space as bits of a float, 0 where there is nothing.
@group(0) @binding(1) var first_sheet: texture_2d<u32>;
@group(0) @binding(2) var second_sheet: texture_2d<u32>;
@group(1) @binding(0) var<uniform> drawable: Drawable;
@group(1) @binding(1) var parts: texture_2d<u32>;
@group(1) @binding(2) var field_colors: texture_2d<f32>;

// Outside of the clip volume for every projection.
const NOWHERE: vec4<f32> = vec4<f32>(2.0, 2.0, 2.0, 1.0);

// Beyond every point of a scene.
const FAR_AWAY: f32 = 3e38;

fn has(bit: u32) -> bool {
    return (drawable.flags.x & bit) != 0u;
}

// Colour and state of a part; all of the drawable's own where the table ends.
fn part_look(part: u32) -> vec4<u32> {
    if part < drawable.flags.y {
        return textureLoad(parts, vec2<u32>(part % PARTS_PER_ROW, part / PARTS_PER_ROW), 0);
    }
    return vec4<u32>(0u, 0u, 0u, PART_VISIBLE);
}

fn view_point(position: vec3<f32>) -> vec3<f32> {
    return (drawable.view_from_mesh * vec4<f32>(position, 1.0)).xyz;
}

fn is_perspective() -> bool {
    return frame.eye.y > 0.5;
}

fn to_eye(p: vec3<f32>) -> vec3<f32> {
    let towards_eye = normalize(vec3<f32>(0.0, 0.0, frame.eye.x) - p);
    return select(vec3<f32>(0.0, 0.0, 1.0), towards_eye, is_perspective());
}

// World length of a pixel at a view point.
fn pixel_size(p: vec3<f32>) -> f32 {
    let nearness = max(frame.eye.x - p.z, 0.0) / frame.eye.x;
    return frame.eye.z * select(1.0, nearness, is_perspective());
}

// A view point moved towards the viewer by some pixels' length, which changes its depth alone.
fn pulled(p: vec3<f32>, pixels: f32) -> vec3<f32> {
    return p + to_eye(p) * (pixel_size(p) * pixels);
}

fn to_clip(p: vec3<f32>) -> vec4<f32> {
    return frame.clip_from_view * vec4<f32>(p, 1.0);
}

// Signed distance to the section plane; positive where the scene is cut away.
fn beyond_section(p: vec3<f32>) -> f32 {
    return dot(frame.section.xyz, p) + frame.section.w;
}

// True if the section or the wipe line removes this fragment.
fn removed(p: vec3<f32>, pixel: vec2<f32>) -> bool {
    if frame.switches.x > 0.5 && beyond_section(p) > 0.0 {
        return true;
    }
    if frame.switches.y >= 0.0 {
        if has(WIPE_LEFT) && pixel.x >= frame.switches.y {
            return true;
        }
        if has(WIPE_RIGHT) && pixel.x < frame.switches.y {
            return true;
        }
    }
    return false;
}

// A field value and 1 where there is one.
fn known_value(field: f32) -> vec2<f32> {
    return select(vec2<f32>(0.0), vec2<f32>(field, 1.0), abs(field) < NO_VALUE);
}

// True if the value of a fragment lies beyond limits outside of which nothing is drawn.
fn beyond_limits(field: vec2<f32>) -> bool {
    if has(HIDES_BEYOND) && field.y > 0.5 {
        let t = (field.x / field.y - drawable.params.x) * drawable.params.y;
        return abs(t - 0.5) > 0.5 + BEYOND;
    }
    return false;
}

// 1 on the lines of a diagonal hatch of the screen, 0 between, smooth at the border.
fn hatch(pixel: vec2<f32>, slope: f32, spacing: f32, width: f32) -> f32 {
    let period = spacing * frame.eye.w;
    let along = fract((pixel.x + slope * pixel.y) / (period * 1.41421356)) - 0.5;
    let distance = abs(along) * period;
    let half = 0.5 * width * frame.eye.w;
    return 1.0 - smoothstep(half - 0.5, half + 0.5, distance);
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    let x = clamp(c, vec3<f32>(0.0), vec3<f32>(1.0));
    return select(1.055 * pow(x, vec3<f32>(1.0 / 2.4)) - 0.055, x * 12.92, x <= vec3<f32>(0.0031308));
}

fn premultiplied(c: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(c.rgb * c.a, c.a);
}

// A screen-space segment with round ends, as a quad of six corners.
struct Segment {
    clip: vec4<f32>,
    // Pixels along the segment from its start, and across.
    place: vec2<f32>,
    length: f32,
    half_width: f32,
}

fn segment_corner(from_view: vec3<f32>, to_view: vec3<f32>, width: f32, corner: u32) -> Segment {
    var a = from_view;
    var b = to_view;
    // What lies behind the eye is cut off before the division.
    let limit = select(FAR_AWAY, frame.eye.x * (1.0 - 1e-4), is_perspective());
    if a.z > limit && b.z < limit {
        a = mix(a, b, (a.z - limit) / (a.z - b.z));
    } else if b.z > limit && a.z < limit {
        b = mix(b, a, (b.z - limit) / (b.z - a.z));
    }
    var result: Segment;
    let clip_a = to_clip(a);
    let clip_b = to_clip(b);
    if clip_a.w <= 0.0 || clip_b.w <= 0.0 {
        result.clip = NOWHERE;
        return result;
    }
    let half_screen = 0.5 * frame.screen.xy;
    let pixel_a = clip_a.xy / clip_a.w * half_screen;
    let pixel_b = clip_b.xy / clip_b.w * half_screen;
    let delta = pixel_b - pixel_a;
    let length = length(delta);
    let along = select(vec2<f32>(1.0, 0.0), delta / max(length, 1e-6), length > 1e-6);
    let across = vec2<f32>(-along.y, along.x);
    let at_end = corner == 1u || corner == 2u || corner == 4u;
    let side = select(-1.0, 1.0, corner == 2u || corner == 4u || corner == 5u);
    let half_width = 0.5 * width;
    // One pixel of air for the soft border.
    let reach = half_width + 1.0;
    let beyond = select(-reach, reach, at_end);
    let pixel = select(pixel_a, pixel_b, at_end) + along * beyond + across * (side * reach);
    let depth = select(clip_a.z / clip_a.w, clip_b.z / clip_b.w, at_end);
    // Divided already, so that places interpolate evenly on the screen.
    result.clip = vec4<f32>(pixel / half_screen, depth, 1.0);
    result.place = vec2<f32>(select(0.0, length, at_end) + beyond, side * reach);
    result.length = length;
    result.half_width = half_width;
    return result;
}

// Coverage of a pixel by the segment.
fn segment_coverage(place: vec2<f32>, length: f32, half_width: f32) -> f32 {
    let outside = max(max(-place.x, place.x - length), 0.0);
    let distance = length_2d(vec2<f32>(outside, place.y));
    // Lines thinner than a pixel fade instead of breaking up.
    let strength = min(2.0 * half_width, 1.0);
    return clamp(max(half_width, 0.5) + 0.5 - distance, 0.0, 1.0) * strength;
}

fn length_2d(v: vec2<f32>) -> f32 {
    return sqrt(dot(v, v));
}
