// Lays a finished picture on the window.

@group(0) @binding(0) var picture: texture_2d<f32>;

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

// Texels are read without a sampler, which costs a software driver more than anything else here.
fn color_at(uv: vec2<f32>) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(picture));
    if !IS_STRETCHED {
        return textureLoad(picture, vec2<i32>(uv * size), 0);
    }
    // Between the centres of four texels.
    let place = clamp(uv * size - 0.5, vec2<f32>(0.0), size - 1.0);
    let low = vec2<i32>(place);
    let high = min(low + 1, vec2<i32>(size) - 1);
    let share = fract(place);
    let upper = mix(textureLoad(picture, low, 0), textureLoad(picture, vec2<i32>(high.x, low.y), 0), share.x);
    let lower = mix(textureLoad(picture, vec2<i32>(low.x, high.y), 0), textureLoad(picture, high, 0), share.x);
    return mix(upper, lower, share.y);
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
