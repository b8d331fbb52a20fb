// Lines, markers and fills. Positions are in view space already.

// Opacity of what lies behind the parts in the faint pass, 1 in the others.
override faintness: f32 = 1.0;

struct LineVaryings {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) half_width: f32,
    @location(2) @interpolate(flat) shape: vec3<f32>,
    @location(3) @interpolate(flat) color: vec4<f32>,
}

@vertex
fn vs_line(
    @location(0) from_view: vec3<f32>,
    @location(1) to_view: vec3<f32>,
    @location(2) widths: vec2<f32>,
    // Length of a dash, pixels of the line before this piece.
    @location(3) dash: vec2<f32>,
    @location(4) color: vec4<f32>,
    @builtin(vertex_index) corner: u32,
) -> LineVaryings {
    let segment = segment_corner(pulled(from_view, 2.0), pulled(to_view, 2.0), widths, corner);
    var out: LineVaryings;
    out.clip = segment.clip;
    out.place = segment.place;
    out.half_width = segment.half_width;
    out.shape = vec3<f32>(segment.length, dash);
    out.color = color;
    return out;
}

@fragment
fn fs_line(in: LineVaryings) -> @location(0) vec4<f32> {
    var coverage = segment_coverage(in.place, in.shape.x, in.half_width);
    if in.shape.y > 0.0 {
        let along = abs(fract((in.place.x + in.shape.z) / (2.0 * in.shape.y)) - 0.5);
        coverage *= clamp((along - 0.25) * 2.0 * in.shape.y + 0.5, 0.0, 1.0);
    }
    return premultiplied(vec4<f32>(in.color.rgb, in.color.a * coverage * faintness));
}

struct MarkerVaryings {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) @interpolate(flat) radius: f32,
    @location(2) @interpolate(flat) shape: u32,
    @location(3) @interpolate(flat) color: vec4<f32>,
    @location(4) @interpolate(flat) rim: vec4<f32>,
}

@vertex
fn vs_marker(
    @location(0) position: vec3<f32>,
    @location(1) size: f32,
    @location(2) shape: u32,
    @location(3) color: vec4<f32>,
    @location(4) rim: vec4<f32>,
    @builtin(vertex_index) corner: u32,
) -> MarkerVaryings {
    var out: MarkerVaryings;
    let center = to_clip(pulled(position, 3.0));
    if center.w <= 0.0 {
        out.clip = NOWHERE;
        return out;
    }
    let right = corner == 1u || corner == 2u || corner == 4u;
    let top = corner == 2u || corner == 4u || corner == 5u;
    let reach = 0.5 * size + 2.0 * frame.eye.w;
    out.place = vec2<f32>(select(-reach, reach, right), select(-reach, reach, top));
    out.clip = vec4<f32>(
        center.xy / center.w + out.place / (0.5 * frame.screen.xy), center.z / center.w, 1.0);
    out.radius = 0.5 * size;
    out.shape = shape;
    out.color = color;
    out.rim = rim;
    return out;
}

// Signed distance in pixels to the marker's outline; negative inside.
fn marker_distance(p: vec2<f32>, radius: f32, shape: u32) -> f32 {
    switch shape {
        case 1u: {
            let stroke = max(0.28 * radius, 1.0);
            return abs(length_2d(p) - radius + stroke) - stroke;
        }
        case 2u: {
            return max(abs(p.x), abs(p.y)) - 0.82 * radius;
        }
        case 3u: {
            // Equilateral, standing on its base.
            let side = abs(p.x) * 0.8660254 + p.y * 0.5;
            return max(side, -p.y) - 0.5 * radius;
        }
        case 4u: {
            let q = vec2<f32>(abs(p.x + p.y), abs(p.x - p.y)) * 0.70710678;
            let stroke = max(0.16 * radius, 0.8);
            return max(min(q.x, q.y) - stroke, max(q.x, q.y) - radius);
        }
        default: {
            return length_2d(p) - radius;
        }
    }
}

@fragment
fn fs_marker(in: MarkerVaryings) -> @location(0) vec4<f32> {
    let distance = marker_distance(in.place, in.radius, in.shape);
    let rim_width = 1.2 * frame.eye.w;
    let inside = clamp(0.5 - distance, 0.0, 1.0) * in.color.a;
    let around = clamp(0.5 + rim_width - distance, 0.0, 1.0) * in.rim.a;
    let color = in.color.rgb * inside + in.rim.rgb * around * (1.0 - inside);
    return vec4<f32>(color, inside + around * (1.0 - inside)) * faintness;
}

struct FillVaryings {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn vs_fill(@location(0) position: vec3<f32>, @location(1) color: vec4<f32>) -> FillVaryings {
    var out: FillVaryings;
    out.clip = to_clip(position);
    out.color = color;
    return out;
}

@fragment
fn fs_fill(in: FillVaryings) -> @location(0) vec4<f32> {
    return premultiplied(vec4<f32>(in.color.rgb, in.color.a * faintness));
}
