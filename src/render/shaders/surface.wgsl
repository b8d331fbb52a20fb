struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) view: vec3<f32>,
    @location(1) normal: vec3<f32>,
    // Field value and 1 where there is one.
    @location(2) field: vec2<f32>,
    @location(3) @interpolate(flat) color: vec3<f32>,
    // Bits of the part.
    @location(4) @interpolate(flat) look: u32,
}

const FIELD_STEPS: f32 = 1024.0;

fn octahedral(e: vec2<f32>) -> vec3<f32> {
    var n = vec3<f32>(e, 1.0 - abs(e.x) - abs(e.y));
    let fold = max(-n.z, 0.0);
    n.x -= select(-fold, fold, n.x >= 0.0);
    n.y -= select(-fold, fold, n.y >= 0.0);
    return normalize(n);
}

@vertex
fn vs_main(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec2<f32>,
    @location(2) part: u32,
    @location(3) field: f32,
) -> Varyings {
    let look = part_look(part);
    var out: Varyings;
    if (look.w & PART_VISIBLE) == 0u {
        out.clip = NOWHERE;
        return out;
    }
    out.view = view_point(position);
    out.clip = to_clip(pulled(out.view, -drawable.params.z));
    let turned = (drawable.view_from_mesh * vec4<f32>(octahedral(normal), 0.0)).xyz;
    out.normal = normalize(turned);
    out.field = known_value(field);
    let own = vec3<f32>(look.rgb) / 255.0;
    out.color = select(drawable.color.rgb, own, (look.w & PART_COLORED) != 0u);
    out.look = look.w;
    return out;
}

struct Light {
    diffuse: f32,
    gloss: f32,
}

// A soft key light from the upper left that travels with the viewer, a weak light from the viewer's
// eye, a fill from the lower right, and light from the sky. Steep enough that gentle bends of a sheet
// show, and never black.
fn light(n: vec3<f32>, v: vec3<f32>) -> Light {
    let key = normalize(vec3<f32>(-0.55, 0.50, 0.70));
    let fill = normalize(vec3<f32>(0.75, -0.35, 0.45));
    let sky = 0.5 + 0.5 * n.y;
    let wrapped = clamp((dot(n, key) + 0.15) / 1.15, 0.0, 1.0);
    let eye = dot(n, v);
    var out: Light;
    out.diffuse = 0.13 + 0.12 * sky + 0.66 * pow(wrapped, 1.5) + 0.22 * eye * eye
        + 0.16 * max(dot(n, fill), 0.0);
    let halfway = normalize(key + v);
    let facing = max(dot(n, halfway), 0.0);
    // Two lobes: the broad one makes bent sheet read as metal, the narrow one as pressed.
    out.gloss = 0.06 * pow(facing, 10.0) + 0.10 * pow(facing, 60.0);
    return out;
}

// Colour of a value; the fourth number names the pattern over it.
fn field_color(value: f32) -> vec4<f32> {
    let t = clamp((value - drawable.params.x) * drawable.params.y, 0.0, 1.0);
    let texel = min(i32(t * FIELD_STEPS), i32(FIELD_STEPS) - 1);
    return textureLoad(field_colors, vec2<i32>(texel, 0), 0);
}

// 1 on the marks of a pattern of the screen: horizontal lines, dots, lines that rise, fall, or both.
fn pattern(pixel: vec2<f32>, name: f32) -> f32 {
    let number = i32(round(name * 5.1));
    if number > 4 {
        return 0.0;
    }
    if number >= 2 {
        let rising = select(0.0, hatch(pixel, 1.0, 5.0, 1.4), number != 3);
        let falling = select(0.0, hatch(pixel, -1.0, 5.0, 1.4), number != 2);
        return max(rising, falling);
    }
    let period = 6.0 * frame.eye.w;
    let half = 0.75 * frame.eye.w;
    if number == 0 {
        let distance = abs(fract(pixel.y / period) - 0.5) * period;
        return 1.0 - smoothstep(half - 0.5, half + 0.5, distance);
    }
    // Every second row is shifted by half a step.
    let row = floor(pixel.y / period);
    let shift = 0.5 * period * (row - 2.0 * floor(0.5 * row));
    let place = (fract(vec2<f32>(pixel.x + shift, pixel.y) / period) - 0.5) * period;
    let radius = 1.5 * frame.eye.w;
    return 1.0 - smoothstep(radius - 0.5, radius + 0.5, length_2d(place));
}

// How much of a fragment belongs to two sheets at once: 1 where the other one lies within the
// distance of coincidence, measured along the normal, falling to 0 at that distance.
fn coincidence(in: Varyings, n: vec3<f32>, v: vec3<f32>) -> f32 {
    var bits = 0u;
    let pixel = vec2<i32>(in.clip.xy);
    if has(FIRST_SHEET) {
        bits = textureLoad(second_sheet, pixel, 0).r;
    } else if has(SECOND_SHEET) {
        bits = textureLoad(first_sheet, pixel, 0).r;
    }
    if bits == 0u {
        return 0.0;
    }
    let along_ray = abs(bitcast<f32>(bits) - in.view.z) / max(abs(v.z), 0.1);
    let distance = along_ray * abs(dot(n, v));
    return 1.0 - smoothstep(0.75, 1.0, distance / frame.switches.w);
}

// Opaque colour of a fragment (sRGB), before opacity.
fn shaded(in: Varyings, front: bool) -> vec3<f32> {
    let v = to_eye(in.view);
    var n = normalize(in.normal);
    let back = front == has(MIRRORED);
    n = select(n, -n, back);
    // Creases aside, smooth normals may point a little away from the viewer near outlines.
    n = normalize(n + v * max(-dot(n, v), 0.0));
    let lit = light(n, v);
    var base = linear_from_srgb(in.color);
    var diffuse = mix(lit.diffuse, 1.0, frame.widths.w);
    var gloss = lit.gloss;
    if has(HAS_FIELD) {
        // Weak light, so that the legend stays true.
        diffuse = mix(1.0, lit.diffuse, 0.45);
        gloss *= 0.3;
        // Between corners with and without a value the border runs half way, and the value is that of
        // the corners which have one.
        if in.field.y > 0.5 {
            let found = field_color(in.field.x / in.field.y);
            base = linear_from_srgb(found.rgb);
            base = mix(base, base * 0.28, pattern(in.clip.xy, found.a));
        } else {
            let stripe = hatch(in.clip.xy, 1.0, 5.0, 1.6);
            base = linear_from_srgb(frame.unmatched_color.rgb) * (1.0 - 0.62 * stripe);
        }
    }
    let both = coincidence(in, n, v);
    if both > 0.0 {
        // The same stripes on either sheet, so that it does not matter which one is in front.
        let stripe = hatch(in.clip.xy, 1.0, 7.0, 3.5);
        let share = select(stripe, 1.0 - stripe, has(SECOND_SHEET));
        base = mix(base, linear_from_srgb(drawable.other_sheet.rgb), share * both);
    }
    var color = (base * diffuse + gloss * mix(vec3<f32>(1.0), base, 0.5)) * frame.switches.z;
    if back {
        // 15 % darker on the screen.
        color *= 0.71;
        let stripe = hatch(in.clip.xy, -1.0, 5.0, 1.0);
        color *= 1.0 - 0.10 * stripe * drawable.other_sheet.w * (1.0 - both);
    }
    if (in.look & PART_HOVERED) != 0u {
        color = mix(color, vec3<f32>(1.0), 0.16);
    }
    if frame.switches.x > 0.5 {
        // The cut itself as a line of two points in the part's own bright colour.
        let depth = -beyond_section(in.view) / max(fwidth(beyond_section(in.view)), 1e-12);
        let line = 1.0 - smoothstep(2.0 * frame.eye.w - 0.5, 2.0 * frame.eye.w + 0.5, depth);
        color = mix(color, linear_from_srgb(mix(in.color, vec3<f32>(1.0), 0.35)), line);
    }
    return srgb_from_linear(color);
}

// True if this fragment is not to be seen: its value lies beyond the limits, or it was removed.
fn hidden(in: Varyings) -> bool {
    return beyond_limits(in.field) || removed(in.view, in.clip.xy);
}

@fragment
fn fs_opaque(in: Varyings, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let color = shaded(in, front);
    if hidden(in) {
        discard;
    }
    return vec4<f32>(color, 1.0);
}

// Glass: more opaque where it is seen edge on.
@fragment
fn fs_clear(in: Varyings, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let color = shaded(in, front);
    if hidden(in) {
        discard;
    }
    let facing = abs(dot(normalize(in.normal), to_eye(in.view)));
    let opacity = drawable.color.a;
    let rim = opacity + (1.0 - opacity) * opacity * pow(1.0 - facing, 2.5);
    return premultiplied(vec4<f32>(color, rim));
}

// The selected area for the outline.
@fragment
fn fs_selected(in: Varyings) -> @location(0) vec4<f32> {
    if (in.look & PART_SELECTED) == 0u || hidden(in) {
        discard;
    }
    return vec4<f32>(1.0);
}

// Depth of a sheet, for the other one; never 0, which stands for nothing.
@fragment
fn fs_depth(in: Varyings) -> @location(0) u32 {
    if hidden(in) {
        discard;
    }
    return bitcast<u32>(select(in.view.z, 1e-30, in.view.z == 0.0));
}
