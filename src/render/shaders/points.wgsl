// Nodes as round dots with a soft border.

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) view: vec3<f32>,
    // Pixels from the centre.
    @location(1) place: vec2<f32>,
    // Field value and 1 where there is one.
    @location(2) field: vec2<f32>,
}

@vertex
fn vs_main(
    @location(0) position: vec3<f32>,
    @location(1) part: u32,
    @location(2) field: f32,
    @builtin(vertex_index) corner: u32,
) -> Varyings {
    var out: Varyings;
    out.view = view_point(position);
    let center = to_clip(pulled(out.view, 1.5 - drawable.params.z));
    if (part_look(part).w & PART_VISIBLE) == 0u || center.w <= 0.0 {
        out.clip = NOWHERE;
        return out;
    }
    let right = corner == 1u || corner == 2u || corner == 4u;
    let top = corner == 2u || corner == 4u || corner == 5u;
    let reach = 0.5 * frame.widths.z + 1.0;
    out.place = vec2<f32>(select(-reach, reach, right), select(-reach, reach, top));
    out.field = known_value(field);
    out.clip = center + vec4<f32>(out.place / (0.5 * frame.screen.xy) * center.w, 0.0, 0.0);
    return out;
}

@fragment
fn fs_main(in: Varyings) -> @location(0) vec4<f32> {
    let distance = length_2d(in.place);
    let radius = 0.5 * frame.widths.z;
    if distance > radius + 0.5 || beyond_limits(in.field) || removed(in.view, in.clip.xy) {
        discard;
    }
    // A dark rim keeps the dots apart from a part of the same colour.
    let rim = smoothstep(radius - 1.3, radius - 0.3, distance);
    let color = mix(mix(drawable.color.rgb, vec3<f32>(1.0), 0.25), vec3<f32>(0.05), rim * 0.8);
    let coverage = clamp(radius + 0.5 - distance, 0.0, 1.0);
    return premultiplied(vec4<f32>(color, coverage * drawable.color.a));
}
