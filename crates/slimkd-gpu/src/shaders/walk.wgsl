// A ray through the tree. Twin: twin/walk.rs, twin/triangle.rs, which say why.

const NONE = 0xffffffffu;
const MOST = 3.40282347e38;
// Below this f32 products may underflow.
const TELLING = 1e-30;
// 2^-21: eight times what rounding can do to a difference of products.
const DOUBT = 4.76837158e-7;
// 2^-18 of the distance to the scene's far side: half-width of a split plane.
const SLACK = 3.81469727e-6;
// 2^-60: smallest direction component over the largest.
const PARALLEL = 8.67361738e-19;
// Rays from farther than this see every plane as a wall to both sides.
const WILD = 1e18;

struct Inner { axis: u32, split: f32, left: u32, right: u32, triangle: u32 }

struct Ray { origin: vec3<f32>, direction: vec3<f32>, t_min: f32, t_max: f32 }

struct Hit { t: f32, u: f32, v: f32, triangle: u32 }

struct Prepared {
    origin: vec3<f32>,
    axis: u32,
    slope: vec2<f32>,
    depth: f32,
    start: vec3<f32>,
    inverse: vec3<f32>,
    slack: vec3<f32>,
    enter: f32,
    exit: f32,
    t_min: f32,
    t_max: f32,
    scale: f32,
    wild: bool,
    valid: bool,
}

fn pick(v: vec3<f32>, axis: u32) -> f32 { return select(select(v.x, v.y, axis == 1u), v.z, axis == 2u); }

// x, y, z as the ray's frame has them.
fn permute(v: vec3<f32>, axis: u32) -> vec3<f32> {
    if axis == 0u { return v.yzx; }
    if axis == 1u { return v.zxy; }
    return v;
}

fn finite(x: f32) -> bool { return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u; }

fn not_a_number(x: f32) -> bool { return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u; }

fn prepare(ray: Ray) -> Prepared {
    var out: Prepared;
    let o = ray.origin;
    let d = ray.direction;
    out.valid = finite(o.x) && finite(o.y) && finite(o.z) && finite(d.x) && finite(d.y) && finite(d.z)
        && !(is_zero(d.x) && is_zero(d.y) && is_zero(d.z)) && !not_a_number(ray.t_min) && !not_a_number(ray.t_max);
    if !out.valid { return out; }
    out.t_min = clamp(ray.t_min, -MOST, MOST);
    out.t_max = clamp(ray.t_max, -MOST, MOST);
    out.origin = o;
    let size = abs(d);
    var axis = 2u;
    if size.x > size.y {
        if size.x > size.z { axis = 0u; }
    } else if size.y > size.z { axis = 1u; }
    out.axis = axis;
    let turned = permute(d, axis);
    out.slope = vec2<f32>(divide(turned.x, turned.z), divide(turned.y, turned.z));
    out.depth = turned.z;
    let power = clamp(bitcast<u32>(abs(turned.z)) & 0x7f800000u, 1u << 23u, 253u << 23u);
    out.scale = bitcast<f32>(power);
    let unscale = bitcast<f32>((254u << 23u) - power);
    let away = max(abs(params.bounds_min.xyz - o), abs(params.bounds_max.xyz - o));
    let reach = max(away.x, max(away.y, away.z));
    let far = reach * params.scale.xyz;
    out.wild = !(reach < WILD && far.x < WILD && far.y < WILD && far.z < WILD)
        || max(params.unscale.x, max(params.unscale.y, params.unscale.z)) >= WILD;
    var enter = out.t_min * out.scale;
    var exit = out.t_max * out.scale;
    for (var k = 0u; k < 3u; k++) {
        var along = d[k] * unscale;
        if abs(along) < PARALLEL { along = select(PARALLEL, -PARALLEL, (bitcast<u32>(d[k]) >> 31u) == 1u); }
        let inverse = 1.0 / along;
        let width = (SLACK * reach + params.cell[k]) * abs(inverse);
        let low = (params.bounds_min[k] - o[k]) * inverse;
        let high = (params.bounds_max[k] - o[k]) * inverse;
        enter = max(enter, min(low, high) - width);
        exit = min(exit, max(low, high) + width);
        out.start[k] = (o[k] - params.low[k]) * params.scale[k] + params.low.w;
        out.inverse[k] = inverse * params.unscale[k];
        out.slack[k] = width;
    }
    if out.wild {
        enter = -MOST;
        exit = MOST;
    }
    out.enter = enter;
    out.exit = exit;
    out.valid = out.t_min <= out.t_max && enter <= exit && params.triangle_count > 0u;
    return out;
}

fn vertex(index: u32) -> vec3<f32> {
    let at = params.vertices + 3u * index;
    return vec3<f32>(bitcast<f32>(word(at)), bitcast<f32>(word(at + 1u)), bitcast<f32>(word(at + 2u)));
}

fn corner_indices(triangle: u32) -> vec3<u32> {
    let at = params.triangles + 3u * triangle;
    return vec3<u32>(word(at), word(at + 1u), word(at + 2u));
}

fn shear(ray: ptr<function, Prepared>, corner: vec3<f32>) -> vec3<f32> {
    let p = permute(keep3(corner - (*ray).origin), (*ray).axis);
    return vec3<f32>(keep(p.x - keep((*ray).slope.x * p.z)), keep(p.y - keep((*ray).slope.y * p.z)), p.z);
}

fn area(p: vec3<f32>, q: vec3<f32>, by: f32) -> Double {
    return add(two_product(p.x * by, q.y * by), minus(two_product(p.y * by, q.x * by)));
}

// A hit's triangle is NONE where there is none.
fn intersect(ray: ptr<function, Prepared>, triangle: u32) -> Hit {
    let miss = Hit(0.0, 0.0, 0.0, NONE);
    let ids = corner_indices(triangle);
    let a = shear(ray, vertex(ids.x));
    let b = shear(ray, vertex(ids.y));
    let c = shear(ray, vertex(ids.z));
    let u = sign_of_difference(c.x, b.y, c.y, b.x);
    let v = sign_of_difference(a.x, c.y, a.y, c.x);
    if u * v < 0 { return miss; }
    let w = sign_of_difference(b.x, a.y, b.y, a.x);
    if u * w < 0 || v * w < 0 || (u == 0 && v == 0 && w == 0) { return miss; }
    // By a power of two that leaves room for products.
    let largest = max(max(max(abs(a.x), abs(a.y)), max(abs(b.x), abs(b.y))), max(abs(c.x), abs(c.y)));
    let by = bitcast<f32>((254u << 23u) - clamp(bitcast<u32>(largest) & 0x7f800000u, 1u << 23u, 253u << 23u));
    let wa = area(c, b, by);
    let wb = area(a, c, by);
    let wc = area(b, a, by);
    let whole = add(add(wa, wb), wc);
    if is_zero(whole.high) { return miss; }
    let along = add(add(times(wa, a.z), times(wb, b.z)), times(wc, c.z));
    let t = quotient(along, times(whole, (*ray).depth));
    return Hit(t, quotient(wb, whole), quotient(wc, whole), triangle);
}

var<private> ring: array<vec4<u32>, RING>;
var<private> trail: array<u32, TRAIL>;

fn set_trail(level: u32, done: bool) {
    let bit = 1u << (level & 31u);
    if done { trail[level >> 5u] |= bit; } else { trail[level >> 5u] &= ~bit; }
}

fn trail_is_set(level: u32) -> bool { return ((trail[level >> 5u] >> (level & 31u)) & 1u) == 1u; }

// The deepest level above `level` whose far child waits; NONE when nothing waits.
fn waiting(level: u32) -> u32 {
    var end = level;
    while end > 0u {
        let at = (end - 1u) >> 5u;
        var open = ~trail[at];
        if (end & 31u) != 0u { open &= (1u << (end & 31u)) - 1u; }
        if open != 0u { return at * 32u + firstLeadingBit(open); }
        end = at * 32u;
    }
    return NONE;
}

fn trace(query: Ray, any: bool) -> Hit {
    var ray = prepare(query);
    var best = Hit(ray.t_max, 0.0, 0.0, NONE);
    if !ray.valid { return best; }
    var at = 0u;
    var level = 0u;
    var resume = 0u;
    var top = 0u;
    var held = 0u;
    var enter = ray.enter;
    var exit = ray.exit;
    loop {
        // Down to a leaf.
        var lower = node_lower(at);
        var skip = false;
        while !is_leaf(lower) {
            let node = inner(at, lower);
            if node.triangle != NONE {
                let found = intersect(&ray, node.triangle);
                if found.triangle != NONE && ray.t_min <= found.t && found.t <= ray.t_max
                    && (found.t < best.t || (found.t == best.t && found.triangle < best.triangle)) {
                    best = found;
                    if any { return best; }
                }
            }
            let inverse = pick(ray.inverse, node.axis);
            let slack = pick(ray.slack, node.axis);
            let middle = (node.split - pick(ray.start, node.axis)) * inverse;
            let first = select(middle - slack, -MOST, ray.wild);
            let last = select(middle + slack, MOST, ray.wild);
            let turned = (bitcast<u32>(inverse) >> 31u) == 1u;
            let near = select(node.left, node.right, turned);
            let far = select(node.right, node.left, turned);
            if exit < first {
                set_trail(level, true);
                at = near;
            } else if last < enter {
                set_trail(level, true);
                at = far;
            } else if level < resume && trail_is_set(level) {
                at = far;
                enter = max(first, enter);
                if level + 1u == resume && enter > best.t * ray.scale {
                    level += 1u;
                    skip = true;
                    break;
                }
            } else {
                set_trail(level, false);
                let wait = max(first, enter);
                ring[top % RING] = vec4<u32>(far, bitcast<u32>(wait), bitcast<u32>(exit), level);
                top += 1u;
                held = min(held + 1u, RING);
                at = near;
                exit = min(last, exit);
            }
            level += 1u;
            lower = node_lower(at);
        }
        if !skip {
            var leaf = open_leaf(at, lower);
            while leaf.left > 0u {
                let found = intersect(&ray, next_id(&leaf));
                if found.triangle != NONE && ray.t_min <= found.t && found.t <= ray.t_max
                    && (found.t < best.t || (found.t == best.t && found.triangle < best.triangle)) {
                    best = found;
                    if any { return best; }
                }
            }
        }
        // On to what waits: from the ring, or from the root along the trail where the ring has forgotten it.
        let limit = best.t * ray.scale;
        var found_next = false;
        while held > 0u {
            top -= 1u;
            held -= 1u;
            let entry = ring[top % RING];
            level = entry.w;
            set_trail(level, true);
            level += 1u;
            if bitcast<f32>(entry.y) <= limit {
                at = entry.x;
                enter = bitcast<f32>(entry.y);
                exit = bitcast<f32>(entry.z);
                resume = 0u;
                found_next = true;
                break;
            }
        }
        if !found_next {
            let next = waiting(level);
            if next == NONE { return best; }
            set_trail(next, true);
            resume = next + 1u;
            level = 0u;
            at = 0u;
            enter = ray.enter;
            exit = ray.exit;
        }
    }
    return best;
}
