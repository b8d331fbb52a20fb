// Lines and fills. Positions are in view space already.

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
    @location(2) width: f32,
    // Length of a dash, pixels of the line before this piece.
    @location(3) dash: vec2<f32>,
    @location(4) color: vec4<f32>,
    @builtin(vertex_index) corner: u32,
) -> LineVaryings {
    let segment = segment_corner(pulled(from_view, 2.0), pulled(to_view, 2.0), width, corner);
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
