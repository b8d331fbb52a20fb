// Element edges as lines of one pixel, creases and borders as quads.

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) view: vec3<f32>,
    // Field value and 1 where there is one.
    @location(1) field: vec2<f32>,
}

@vertex
fn vs_thin(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
    @location(2) part: u32,
    @location(3) field: f32,
) -> Varyings {
    var out: Varyings;
    if (part_look(part).w & PART_VISIBLE) == 0u {
        out.clip = NOWHERE;
        return out;
    }
    out.view = view_point(position);
    out.clip = to_clip(pulled(out.view, 0.6 - drawable.params.z));
    out.field = known_value(field);
    return out;
}

@fragment
fn fs_thin(in: Varyings) -> @location(0) vec4<f32> {
    if beyond_limits(in.field) || removed(in.view, in.clip.xy) {
        discard;
    }
    let color = select(frame.edge_color, vec4<f32>(drawable.color.rgb, 1.0), has(BARE));
    return premultiplied(vec4<f32>(color.rgb, color.a * drawable.params.w * drawable.color.a));
}

struct WideVaryings {
    @builtin(position) clip: vec4<f32>,
    @location(0) view: vec3<f32>,
    @location(1) place: vec2<f32>,
    @location(2) @interpolate(flat) shape: vec2<f32>,
    @location(3) @interpolate(flat) color: vec4<f32>,
    @location(4) field: vec2<f32>,
}

const BORDER_BIT: u32 = 0x80000000u;

@vertex
fn vs_wide(
    @location(0) from_position: vec3<f32>,
    @location(1) to_position: vec3<f32>,
    @location(2) part: u32,
    @location(3) fields: vec2<f32>,
    @builtin(vertex_index) corner: u32,
) -> WideVaryings {
    var out: WideVaryings;
    if (part_look(part & ~BORDER_BIT).w & PART_VISIBLE) == 0u {
        out.clip = NOWHERE;
        return out;
    }
    let border = (part & BORDER_BIT) != 0u;
    let width = select(frame.widths.x, frame.widths.y, border);
    let from_view = view_point(from_position);
    let to_view = view_point(to_position);
    let pull = 1.2 - drawable.params.z;
    let segment = segment_corner(
        pulled(from_view, pull), pulled(to_view, pull), width, corner);
    out.clip = segment.clip;
    let at_end = corner == 1u || corner == 2u || corner == 4u;
    out.view = select(from_view, to_view, at_end);
    out.field = known_value(select(fields.x, fields.y, at_end));
    out.place = segment.place;
    out.shape = vec2<f32>(segment.length, segment.half_width);
    // Of a clear part its lines are what is seen best, so they carry its colour.
    out.color = select(
        select(frame.feature_color, frame.border_color, border),
        vec4<f32>(drawable.color.rgb, select(0.8, 1.0, border)),
        has(BARE) | (drawable.color.a < 1.0));
    return out;
}

@fragment
fn fs_wide(in: WideVaryings) -> @location(0) vec4<f32> {
    if beyond_limits(in.field) || removed(in.view, in.clip.xy) {
        discard;
    }
    let coverage = segment_coverage(in.place, in.shape.x, in.shape.y);
    return premultiplied(vec4<f32>(in.color.rgb, in.color.a * coverage * min(4.0 * drawable.color.a, 1.0)));
}
