struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) height: f32,
}

// One triangle that covers the screen.
@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varyings {
    let x = f32(i32(index & 1u) * 4 - 1);
    let y = f32(i32(index >> 1u) * 4 - 1);
    var out: Varyings;
    out.clip = vec4<f32>(x, y, 0.0, 1.0);
    out.height = 0.5 + 0.5 * y;
    return out;
}

// Noise of half a step, so that the gradient shows no bands.
fn dither(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
}

@fragment
fn fs_main(in: Varyings) -> @location(0) vec4<f32> {
    let color = mix(frame.background_bottom.rgb, frame.background_top.rgb, in.height);
    return vec4<f32>(color + dither(in.clip.xy) / 255.0, 1.0);
}
