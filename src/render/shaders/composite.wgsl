// Lays a finished picture on the window, texel for pixel.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var smooth_sampler: sampler;

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varyings {
    let x = f32(i32(index & 1u) * 4 - 1);
    let y = f32(i32(index >> 1u) * 4 - 1);
    var out: Varyings;
    out.clip = vec4<f32>(x, y, 0.0, 1.0);
    out.uv = vec2<f32>(0.5 + 0.5 * x, 0.5 - 0.5 * y);
    return out;
}

// A picture with other pixels than the window.
override IS_STRETCHED: bool = false;

// A texel is read as it is where it is a pixel of the window: samplers cost more than anything else here.
fn color_at(uv: vec2<f32>) -> vec4<f32> {
    if IS_STRETCHED {
        return textureSample(picture, smooth_sampler, uv);
    }
    return textureLoad(picture, vec2<i32>(uv * vec2<f32>(textureDimensions(picture))), 0);
}

// For targets that hold sRGB values as they are.
@fragment
fn fs_gamma(in: Varyings) -> @location(0) vec4<f32> {
    return color_at(in.uv);
}

// For targets that encode to sRGB themselves.
@fragment
fn fs_linear(in: Varyings) -> @location(0) vec4<f32> {
    let c = color_at(in.uv);
    let low = c.rgb / 12.92;
    let high = pow((c.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, c.rgb <= vec3<f32>(0.04045)), c.a);
}
