// A line of two points around the selected area, with a thin rim of the opposite lightness.

@group(1) @binding(0) var mask: texture_2d<f32>;

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let x = f32(i32(index & 1u) * 4 - 1);
    let y = f32(i32(index >> 1u) * 4 - 1);
    return vec4<f32>(x, y, 0.0, 1.0);
}

fn selected(pixel: vec2<i32>) -> f32 {
    let size = vec2<i32>(textureDimensions(mask));
    let inside = clamp(pixel, vec2<i32>(0), size - 1);
    return textureLoad(mask, inside, 0).r;
}

// Largest mask value on a circle.
fn reached(center: vec2<i32>, radius: f32) -> f32 {
    var found = 0.0;
    for (var i = 0; i < 16; i++) {
        let angle = f32(i) * 0.39269908;
        let step = vec2<f32>(cos(angle), sin(angle)) * radius;
        found = max(found, selected(center + vec2<i32>(round(step))));
    }
    return found;
}

@fragment
fn fs_main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let center = vec2<i32>(position.xy);
    let own = selected(center);
    let width = 2.0 * frame.eye.w;
    let near = max(max(reached(center, 0.5 * width), reached(center, width)), own);
    let far = max(reached(center, width + frame.eye.w), near);
    let line = near * (1.0 - own);
    let rim = (far - near) * 0.55 * (1.0 - own);
    let color = frame.selection_color.rgb;
    let opposite = vec3<f32>(1.0) - color;
    return vec4<f32>(color * line + opposite * rim, line + rim);
}
