// From a hit to the surface there: slimkd-render's surface.rs and offset.rs. Twin: twin/surface.rs.
//
// Whatever decides where a ray starts or goes is computed operation by operation as there, f64 as sums of two floats: where
// surfaces coincide, the last bit says which is seen.

// Offset over the largest coordinate of a triangle: 2^-19.
const RELATIVE = 1.9073486328125e-6;
// The least cosine that a shading normal keeps towards the viewer.
const MIN_FACING = 1e-3;

struct Surface {
    position: vec3<f32>,
    geometric: vec3<f32>,
    shading: vec3<f32>,
    shadow_origin: vec3<f32>,
    offset: f32,
    uv: vec2<f32>,
    has_uv: bool,
    outside: bool,
    valid: bool,
}

fn largest_of(v: vec3<f32>) -> f32 { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// A power of two that brings numbers of that size near to 1.
fn unscale_of(size: f32) -> f32 {
    return bitcast<f32>((254u << 23u) - clamp(bitcast<u32>(size) & 0x7f800000u, 1u << 23u, 253u << 23u));
}

fn is_finite3(v: vec3<f32>) -> bool { return finite(v.x) && finite(v.y) && finite(v.z); }

fn inner_product(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let p = keep3(a * b);
    return keep(keep(p.x + p.y) + p.z);
}

// a + b * s
fn along(a: vec3<f32>, b: vec3<f32>, s: f32) -> vec3<f32> { return keep3(a + keep3(b * s)); }

// At unit length; zero where there is none.
fn normalized(v: vec3<f32>) -> vec3<f32> {
    let square = inner_product(v, v);
    if !finite(square) || is_zero(square) { return vec3<f32>(0.0); }
    return keep3(v * keep(1.0 / keep(sqrt(square))));
}

// The same in two floats.
fn unit_of(x: Double, y: Double, z: Double) -> vec3<f32> {
    let by = unscale_of(max(abs(x.high), max(abs(y.high), abs(z.high))));
    let v = array<Double, 3>(scaled(x, by), scaled(y, by), scaled(z, by));
    let square = add(add(product_of(v[0], v[0]), product_of(v[1], v[1])), product_of(v[2], v[2]));
    if !finite(square.high) || is_zero(square.high) { return vec3<f32>(0.0); }
    // 1/sqrt, bettered once.
    let r = keep(inverseSqrt(square.high));
    let one = times(times(square, r), r);
    let rest = keep(keep(1.0 - one.high) - one.low);
    let more = rest * (0.5 + 0.375 * rest);
    return vec3<f32>(bettered(times(v[0], r), more), bettered(times(v[1], r), more), bettered(times(v[2], r), more));
}

fn bettered(x: Double, more: f32) -> f32 { return two_sum(x.high, keep(x.low + keep(x.high * more))).high; }

// By a power of two.
fn scaled(x: Double, by: f32) -> Double { return Double(x.high * by, x.low * by); }

fn is_none(v: vec3<f32>) -> bool { return is_zero(v.x) && is_zero(v.y) && is_zero(v.z); }

fn product_of(a: Double, b: Double) -> Double {
    let p = two_product(a.high, b.high);
    return two_sum(p.high, keep(p.low + keep(keep(a.high * b.low) + keep(a.low * b.high))));
}

fn edge(from_corner: f32, to_corner: f32, by: f32) -> Double {
    return scaled(two_sum(to_corner, -from_corner), by);
}

// The normal by corners, exact to the last bits: needles cancel.
fn normal_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec3<f32> {
    let p = unscale_of(largest_of(b - a));
    let q = unscale_of(largest_of(c - a));
    let bx = edge(a.x, b.x, p);
    let by = edge(a.y, b.y, p);
    let bz = edge(a.z, b.z, p);
    let cx = edge(a.x, c.x, q);
    let cy = edge(a.y, c.y, q);
    let cz = edge(a.z, c.z, q);
    let x = add(product_of(by, cz), minus(product_of(bz, cy)));
    let y = add(product_of(bz, cx), minus(product_of(bx, cz)));
    let z = add(product_of(bx, cy), minus(product_of(by, cx)));
    return unit_of(x, y, z);
}

fn blend(a: f32, b: f32, c: f32, weight: Double, u: f32, v: f32) -> Double {
    return add(add(times(weight, a), two_product(b, u)), two_product(c, v));
}

// The hit's point, moved towards the triangle's centre.
fn position_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, hit: Hit, offset: f32) -> vec3<f32> {
    let weight = add(two_sum(1.0, -hit.u), Double(-hit.v, 0.0));
    let x = blend(a.x, b.x, c.x, weight, hit.u, hit.v);
    let y = blend(a.y, b.y, c.y, weight, hit.u, hit.v);
    let z = blend(a.z, b.z, c.z, weight, hit.u, hit.v);
    let point = vec3<f32>(x.high, y.high, z.high);
    let way = ((a - point) + (b - point) + (c - point)) / 3.0 - vec3<f32>(x.low, y.low, z.low);
    let unit = unit_of(Double(way.x, 0.0), Double(way.y, 0.0), Double(way.z, 0.0));
    let step = unit * min(offset, dot(way, unit));
    return vec3<f32>(
        add(x, Double(step.x, 0.0)).high,
        add(y, Double(step.y, 0.0)).high,
        add(z, Double(step.z, 0.0)).high,
    );
}

fn word3(at: u32) -> vec3<u32> { return vec3<u32>(word(at), word(at + 1u), word(at + 2u)); }

fn float3(at: u32) -> vec3<f32> { return bitcast<vec3<f32>>(word3(at)); }

// Which values the corners have.
fn attribute_of(indices: u32, triangle: u32, corners: vec3<u32>) -> vec3<u32> {
    if indices == NONE { return corners; }
    return word3(indices + 3u * triangle);
}

fn are_below(index: vec3<u32>, count: u32) -> bool { return all(index < vec3<u32>(count)); }

fn facing(shading: vec3<f32>, geometric: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let cosine = -inner_product(shading, direction);
    if cosine >= MIN_FACING { return shading; }
    let turned = normalized(along(shading, direction, -keep(MIN_FACING - cosine)));
    return select(turned, geometric, is_none(turned));
}

fn lifted(so_far: vec3<f32>, position: vec3<f32>, corner: vec3<f32>, normal: vec3<f32>, weight: f32) -> vec3<f32> {
    let below = min(inner_product(keep3(position - corner), normal), 0.0);
    return along(so_far, normal, -keep(below * weight));
}

fn blended(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, weights: vec3<f32>) -> vec3<f32> {
    return along(along(keep3(a * weights.x), b, weights.y), c, weights.z);
}

fn unit_normal(index: u32) -> vec3<f32> {
    let n = float3(frame.normals + 3u * index);
    return unit_of(Double(n.x, 0.0), Double(n.y, 0.0), Double(n.z, 0.0));
}

fn surface_at(hit: Hit, direction: vec3<f32>) -> Surface {
    var out: Surface;
    if hit.triangle == NONE { return out; }
    let ids = corner_indices(hit.triangle);
    let a = vertex(ids.x);
    let b = vertex(ids.y);
    let c = vertex(ids.z);
    var geometric = normal_of(a, b, c);
    if is_none(geometric) { return out; }
    out.valid = true;
    out.offset = max(largest_of(a), max(largest_of(b), largest_of(c))) * RELATIVE;
    out.position = position_of(a, b, c, hit, out.offset);
    let weights = vec3<f32>(keep(keep(1.0 - hit.u) - hit.v), hit.u, hit.v);

    var shading = geometric;
    var curved = false;
    var na: vec3<f32>;
    var nb: vec3<f32>;
    var nc: vec3<f32>;
    if frame.normals != NONE {
        let index = attribute_of(frame.normal_indices, hit.triangle, ids);
        if are_below(index, frame.normal_count) {
            na = unit_normal(index.x);
            nb = unit_normal(index.y);
            nc = unit_normal(index.z);
            curved = !(is_none(na) || is_none(nb) || is_none(nc));
        }
    }
    if curved {
        let smoothed = normalized(blended(na, nb, nc, weights));
        shading = select(smoothed, geometric, is_none(smoothed));
    }
    // Files get their winding wrong more often than their normals.
    if inner_product(geometric, shading) < 0.0 { geometric = -geometric; }
    out.outside = inner_product(geometric, direction) <= 0.0;
    let side = select(-1.0, 1.0, out.outside);
    geometric *= side;
    shading *= side;
    out.geometric = geometric;
    out.shading = facing(shading, geometric, direction);

    out.shadow_origin = out.position;
    if curved {
        let p = out.position;
        out.shadow_origin = lifted(lifted(lifted(p, p, a, na * side, weights.x), p, b, nb * side, weights.y), p, c,
            nc * side, weights.z);
    }
    if frame.uvs != NONE {
        let index = attribute_of(frame.uv_indices, hit.triangle, ids);
        out.has_uv = are_below(index, frame.uv_count);
        if out.has_uv { out.uv = uv_at(index.x) * weights.x + uv_at(index.y) * weights.y + uv_at(index.z) * weights.z; }
    }
    return out;
}

fn uv_at(index: u32) -> vec2<f32> {
    let at = frame.uvs + 2u * index;
    return vec2<f32>(bitcast<f32>(word(at)), bitcast<f32>(word(at + 1u)));
}

// Where a ray starts that leaves in `direction`, to either side.
fn start_of(surface: Surface, direction: vec3<f32>) -> vec3<f32> {
    let away = inner_product(direction, surface.geometric) >= 0.0;
    return along(surface.position, surface.geometric, select(-surface.offset, surface.offset, away));
}

// Where rays to lights start.
fn lifted_start(surface: Surface) -> vec3<f32> {
    return along(surface.shadow_origin, surface.geometric, surface.offset);
}
