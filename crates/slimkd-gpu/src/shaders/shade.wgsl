// What a surface sends back: slimkd-render's shade.rs, fresnel.rs, sampling.rs, settings.rs. Twin: twin/shade.rs.

// Words of a material: diffuse, texture, specular, shininess, emission, ior, shares (mirrored, let through, opaque), unused.
const MATERIAL = 16u;
// Words of a light: what it is, where or from where, its strength.
const LIGHT = 8u;
const POINT = 0.0;

fn hash(x: u32, y: u32, z: u32) -> u32 { return pcg(x + pcg(y + pcg(z))); }

fn pcg(v: u32) -> u32 {
    let state = v * 747796405u + 2891336453u;
    let mixed = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (mixed >> 22u) ^ mixed;
}

fn unit(bits: u32) -> f32 { return f32(bits >> 8u) * 5.9604644775390625e-8; }

fn stratified(seed: u32, index: u32, count: u32) -> vec2<f32> {
    let jitter = unit(hash(seed, index, 1u));
    let x = divide(keep(f32(index) + jitter), f32(count));
    return vec2<f32>(min(x, 0.99999988), unit(reverseBits(index) ^ hash(seed, 0u, 2u)));
}

// Sine and cosine of an angle from 0 to 2π, rounded as a good library does it: drivers may err by 2^-11.
fn sine_cosine(angle: f32) -> vec2<f32> {
    let quarter = floor(angle * 0.63661977 + 0.5);
    // π/2 is the sum of three floats.
    let near = add(Double(angle, 0.0), minus(two_product(quarter, 1.57079637)));
    let r = add(add(near, minus(two_product(quarter, -4.37113883e-8))), Double(quarter * 1.71512451e-15, 0.0));
    let q = product_of(r, r);
    let qq = product_of(q, q);
    let h = q.high;
    let s = add(
        add(Double(1.0, 0.0), minus(product_of(q, Double(1.66666672e-1, -4.96705388e-9)))),
        add(product_of(qq, Double(8.33333377e-3, -4.34617203e-10)), Double(h * h * h * (-1.984127e-4 + h * 2.7557319e-6), 0.0)),
    );
    let c = add(
        add(Double(1.0, 0.0), Double(-0.5 * q.high, -0.5 * q.low)),
        add(product_of(qq, Double(4.16666679e-2, -1.24176347e-9)), Double(h * h * h * (-1.3888889e-3 + h * 2.4801587e-5), 0.0)),
    );
    let sine = product_of(r, s).high;
    let k = u32(quarter) & 3u;
    let turned = select(vec2<f32>(sine, c.high), vec2<f32>(c.high, -sine), (k & 1u) == 1u);
    return select(turned, -turned, k >= 2u);
}

// x^n for x from 0 to 1: a driver's logarithm would be off by n · 2^-21.
fn power(x: f32, n: f32) -> f32 {
    if x <= 0.0 { return 0.0; }
    if x >= 1.0 { return 1.0; }
    let bits = bitcast<u32>(x);
    var exponent = i32(bits >> 23u) - 127;
    var mantissa = bitcast<f32>((bits & 0x7fffffu) | 0x3f800000u);
    if mantissa > 1.41421356 {
        mantissa *= 0.5;
        exponent += 1;
    }
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let q = s * s;
    let series = s * (2.0 + q * (6.6666667e-1 + q * (0.4 + q * (2.8571429e-1 + q * 2.2222222e-1))));
    let y = n * (f32(exponent) + series * 1.44269504);
    if y < -126.0 { return 0.0; }
    let whole = floor(y);
    let f = (y - whole) * 0.69314718;
    let fraction = 1.0 + f * (1.0 + f * (0.5 + f * (1.6666667e-1 + f * (4.1666667e-2 + f * (8.3333333e-3
        + f * (1.3888889e-3 + f * (1.9841270e-4 + f * 2.4801587e-5)))))));
    return fraction * bitcast<f32>(u32(i32(whole) + 127) << 23u);
}

fn sky_radiance(height: f32) -> vec3<f32> {
    let far = select(frame.ground.xyz, frame.zenith.xyz, height >= 0.0);
    return mix(frame.horizon.xyz, far, sqrt(min(abs(height), 1.0)));
}

fn sky_irradiance(height: f32) -> vec3<f32> {
    let above = 0.5 * (frame.zenith.xyz + frame.horizon.xyz);
    let below = 0.5 * (frame.ground.xyz + frame.horizon.xyz);
    return mix(below, above, 0.5 + 0.5 * clamp(height, -1.0, 1.0)) * frame.zenith.w;
}

fn material_of(triangle: u32) -> u32 {
    var id = 0u;
    if triangle < frame.material_id_count { id = word(frame.material_ids + triangle); }
    return frame.materials + MATERIAL * id;
}

fn float_at(at: u32) -> f32 { return bitcast<f32>(word(at)); }

fn wrapped(index: f32, step: i32, size: u32) -> u32 {
    let n = i32(size);
    return u32((i32(index) + step + n) % n);
}

// Bilinear and repeated, as slimkd_scene::Texture::sample.
fn texture_at(texture: u32, uv: vec2<f32>) -> vec3<f32> {
    let record = frame.textures + 4u * texture;
    let width = word(record + 1u);
    let height = word(record + 2u);
    if width == 0u || height == 0u || !finite(uv.x) || !finite(uv.y) { return vec3<f32>(1.0); }
    let x = (uv.x - floor(uv.x)) * f32(width) - 0.5;
    let y = (1.0 - (uv.y - floor(uv.y))) * f32(height) - 0.5;
    let left = floor(x);
    let top = floor(y);
    let first = frame.textures + word(record);
    let row0 = wrapped(top, 0, height) * width;
    let row1 = wrapped(top, 1, height) * width;
    let column0 = wrapped(left, 0, width);
    let column1 = wrapped(left, 1, width);
    let upper = mix(float3(first + 3u * (row0 + column0)), float3(first + 3u * (row0 + column1)), x - left);
    let lower = mix(float3(first + 3u * (row1 + column0)), float3(first + 3u * (row1 + column1)), x - left);
    return mix(upper, lower, y - top);
}

// The diffuse colour times its share.
fn diffuse_of(material: u32, surface: Surface) -> vec3<f32> {
    var colour = float3(material);
    let texture = word(material + 3u);
    if texture != NONE && surface.has_uv { colour *= texture_at(texture, surface.uv); }
    return colour * float_at(material + 14u);
}

// What a light would add if nothing stood before it, and the ray that finds out.
struct Lit { seen: vec3<f32>, ray: Ray, adds: bool }

fn lit(index: u32, material: u32, surface: Surface, direction: vec3<f32>, diffuse: vec3<f32>, weight: f32) -> Lit {
    var out: Lit;
    let at = LIGHT * index;
    let place = vec3<f32>(lights[at + 1u], lights[at + 2u], lights[at + 3u]);
    var irradiance = vec3<f32>(lights[at + 4u], lights[at + 5u], lights[at + 6u]);
    let near = lights[at] == POINT;
    var towards = place;
    if near {
        let way = keep3(place - surface.position);
        towards = normalized(way);
        if is_none(towards) { return out; }
        let distance = dot(way, towards);
        irradiance /= max(distance * distance, 1.17549435e-38);
    }
    let cosine = dot(surface.shading, towards);
    if cosine <= 0.0 || dot(surface.geometric, towards) <= 0.0 { return out; }
    var half = normalized(towards - direction);
    if is_none(half) { half = surface.shading; }
    let highlight = power(dot(surface.shading, half), float_at(material + 7u));
    out.seen = irradiance * (diffuse * cosine + float3(material + 4u) * highlight);
    if max(out.seen.x, max(out.seen.y, out.seen.z)) * weight <= 0.0 { return out; }
    out.adds = true;
    let origin = lifted_start(surface);
    if near { out.ray = Ray(origin, keep3(place - origin), 0.0, 0.9999); } else { out.ray = Ray(origin, towards, 0.0, MOST); }
    return out;
}

// Share that a dielectric reflects; 1 is total reflection.
fn reflectance(cosine: f32, eta: f32) -> f32 {
    let cos_i = clamp(cosine, 0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 { return 1.0; }
    let cos_t = sqrt(1.0 - sin2_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// By Snell's law; zero is total reflection.
fn refracted(direction: vec3<f32>, normal: vec3<f32>, eta: f32) -> vec3<f32> {
    let cos_i = -inner_product(direction, normal);
    let sin2_t = keep(max(keep(1.0 - keep(cos_i * cos_i)), 0.0) / keep(eta * eta));
    if sin2_t >= 1.0 { return vec3<f32>(0.0); }
    let cos_t = keep(sqrt(keep(1.0 - sin2_t)));
    return normalized(along(keep3(direction / eta), normal, keep(keep(cos_i / eta) - cos_t)));
}

fn mirrored(direction: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    return along(direction, normal, -2.0 * inner_product(direction, normal));
}

// Direction number `index` of a pixel's ambient occlusion, cosine-weighted (Malley's method).
fn occlusion_direction(surface: Surface, seed: u32, index: u32) -> vec3<f32> {
    let point = stratified(seed, index, frame.occlusion * frame.samples);
    let n = surface.shading;
    // any_orthonormal_pair of glam: Duff et al. 2017.
    let sign = select(1.0, -1.0, n.z < 0.0);
    let a = keep(-1.0 / keep(sign + n.z));
    let b = keep(keep(n.x * n.y) * a);
    let tangent = vec3<f32>(keep(1.0 + keep(keep(sign * n.x * n.x) * a)), sign * b, -sign * n.x);
    let bitangent = vec3<f32>(b, keep(sign + keep(keep(n.y * n.y) * a)), -n.y);
    let turned = sine_cosine(keep(point.y * 6.2831855));
    let flat = along(keep3(tangent * turned.y), bitangent, turned.x);
    let radius = keep(sqrt(point.x));
    return along(keep3(flat * radius), n, keep(sqrt(max(keep(1.0 - point.x), 0.0))));
}
