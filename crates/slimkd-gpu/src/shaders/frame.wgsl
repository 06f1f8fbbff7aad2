// Whitted's picture: a thread a pixel, and one place where rays are traced. Whatever a thread's next ray is for - to go on, to a
// light, for ambient occlusion - it walks the tree beside its neighbours'. Twin: twin/frame.rs.

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<storage, read> lights: array<f32>;
@group(1) @binding(2) var<storage, read_write> film: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> counters: array<atomic<u32>, 4>;

// What a ray is for.
const PATH = 0u;
const SHADOW = 1u;
const OCCLUSION = 2u;
// Transparent surfaces that a shadow ray may pass.
const MAX_TRANSPARENT = 32u;

// A mirrored or refracted ray that waits.
struct Waiting { origin: vec3<f32>, weight: f32, direction: vec3<f32>, depth: u32 }

var<private> waiting_rays: array<Waiting, PENDING>;
var<private> held_rays: u32;
// Shadow, reflection, refraction, occlusion.
var<private> counts: vec4<u32>;

fn two(high: vec4<f32>, low: vec4<f32>, k: u32) -> Double { return Double(high[k], low[k]); }

// A component of the way to a point of the picture.
fn through(x: Double, y: Double, k: u32) -> Double {
    let across = product_of(two(frame.right, frame.right_rest, k), x);
    let upwards = product_of(two(frame.above, frame.above_rest, k), y);
    return add(two(frame.forward, frame.forward_rest, k), add(across, upwards));
}

// The camera's ray through a point of the picture, as if in f64.
fn primary(pixel: vec2<u32>, sample: u32) -> vec3<f32> {
    var within = vec2<f32>(0.5);
    if frame.samples > 1u { within = stratified(hash(pixel.x, pixel.y, 0u), sample, frame.samples); }
    let px = divide(keep(f32(pixel.x) + within.x), f32(frame.width));
    let py = divide(keep(f32(pixel.y) + within.y), f32(frame.height));
    let x = two_sum(2.0 * px, -1.0);
    let y = two_sum(1.0, -2.0 * py);
    return unit_of(through(x, y, 0u), through(x, y, 1u), through(x, y, 2u));
}

fn follow(surface: Surface, towards: vec3<f32>, share: f32, path: Waiting) {
    let direction = normalized(towards);
    waiting_rays[held_rays] = Waiting(start_of(surface, direction), path.weight * share, direction, path.depth + 1u);
    held_rays += 1u;
}

// The rays that go on from a surface.
fn branch(material: u32, surface: Surface, path: Waiting) {
    if path.depth >= frame.max_depth { return; }
    let least = frame.horizon.w;
    let transmission = float_at(material + 13u);
    var reflection = float_at(material + 12u);
    var refraction = vec3<f32>(0.0);
    var share = 0.0;
    if transmission > 0.0 {
        let ior = float_at(material + 11u);
        let eta = select(1.0 / ior, ior, surface.outside);
        refraction = refracted(path.direction, surface.shading, eta);
        if is_none(refraction) {
            reflection += transmission;
        } else {
            let fresnel = reflectance(-dot(path.direction, surface.shading), eta);
            reflection += transmission * fresnel;
            // Below the shading normal's horizon but above the triangle's: straight on.
            if inner_product(refraction, surface.geometric) >= 0.0 { refraction = path.direction; }
            share = transmission * (1.0 - fresnel);
        }
    }
    if reflection > 0.0 && path.weight * reflection >= least {
        counts.y += 1u;
        var towards = mirrored(path.direction, surface.shading);
        if inner_product(towards, surface.geometric) <= 0.0 { towards = mirrored(path.direction, surface.geometric); }
        follow(surface, towards, reflection, path);
    }
    if !is_none(refraction) && path.weight * share >= least {
        counts.z += 1u;
        follow(surface, refraction, share, path);
    }
}

// What arrives at a pixel's sample.
fn radiance(pixel: vec2<u32>, sample: u32) -> vec3<f32> {
    let seed = hash(pixel.x, pixel.y, 1u);
    var total = vec3<f32>(0.0);
    var path = Waiting(frame.eye.xyz, 1.0, primary(pixel, sample), 0u);
    var ray = Ray(path.origin, path.direction, 0.0, MOST);
    var purpose = PATH;
    held_rays = 0u;
    // The surface that is being shaded, and how far that is.
    var here: Surface;
    var material = 0u;
    var diffuse = vec3<f32>(0.0);
    var colour = vec3<f32>(0.0);
    var occlusions = 0u;
    var turn = 0u;
    var open = 0.0;
    var ambient_waits = false;
    var light = 0u;
    var seen = vec3<f32>(0.0);
    var visible = 1.0;
    var passed = 0u;
    loop {
        let hit = trace(ray, purpose == SHADOW && frame.transparent == 0u);
        let free = hit.triangle == NONE;
        var shading = true;
        var again = false;
        if purpose == PATH {
            here = surface_at(hit, path.direction);
            shading = here.valid;
            if shading {
                material = material_of(hit.triangle);
                diffuse = diffuse_of(material, here);
                colour = float3(material + 8u);
                ambient_waits = !is_none(diffuse);
                occlusions = select(0u, frame.occlusion, ambient_waits && path.depth == 0u);
                turn = 0u;
                open = 0.0;
                light = 0u;
                branch(material, here, path);
            } else {
                total += path.weight * sky_radiance(dot(path.direction, frame.up.xyz));
            }
        } else if purpose == OCCLUSION {
            open += select(hit.t / frame.up.w, 1.0, free);
        } else if free {
            colour += seen * visible;
            light += 1u;
        } else if frame.transparent == 0u {
            light += 1u;
        } else {
            visible *= float_at(material_of(hit.triangle) + 13u);
            passed += 1u;
            if visible < frame.horizon.w || passed == MAX_TRANSPARENT {
                light += 1u;
            } else {
                // The next float, and no subnormal one.
                ray.t_min = bitcast<f32>(max(bitcast<u32>(hit.t) + 1u, 0x00800000u));
                counts.x += 1u;
                again = true;
            }
        }
        if shading && !again {
            shading = false;
            while turn < occlusions && !shading {
                let towards = occlusion_direction(here, seed, sample * frame.occlusion + turn);
                turn += 1u;
                if dot(towards, here.geometric) > 0.0 {
                    ray = Ray(lifted_start(here), towards, 0.0, frame.up.w);
                    purpose = OCCLUSION;
                    counts.w += 1u;
                    shading = true;
                }
            }
            if !shading {
                if ambient_waits {
                    ambient_waits = false;
                    let openness = select(open / f32(max(occlusions, 1u)), 1.0, occlusions == 0u);
                    colour += diffuse * sky_irradiance(dot(here.shading, frame.up.xyz)) * openness;
                }
                while light < frame.light_count && !shading {
                    let found = lit(light, material, here, path.direction, diffuse, path.weight);
                    if found.adds {
                        seen = found.seen;
                        ray = found.ray;
                        purpose = SHADOW;
                        visible = 1.0;
                        passed = 0u;
                        counts.x += 1u;
                        shading = true;
                    } else {
                        light += 1u;
                    }
                }
            }
            if !shading { total += path.weight * colour; }
        }
        if !shading {
            if held_rays == 0u { break; }
            held_rays -= 1u;
            path = waiting_rays[held_rays];
            ray = Ray(path.origin, path.direction, 0.0, MOST);
            purpose = PATH;
        }
    }
    return total;
}

// A workgroup is a block of pixels, its threads numbered in rows: with a workgroup of two dimensions and fewer than eight columns
// llvmpipe 22.3 gives wrong answers.
@compute @workgroup_size(BLOCK_X * BLOCK_Y)
fn render_frame(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let id = group.xy * vec2<u32>(BLOCK_X, BLOCK_Y) + vec2<u32>(index % BLOCK_X, index / BLOCK_X);
    if id.x >= frame.tile_width || id.y >= frame.tile_height { return; }
    let pixel = vec2<u32>(frame.tile_x + id.x, frame.tile_y + id.y);
    let at = id.y * frame.tile_width + id.x;
    var sum = vec3<f32>(0.0);
    if frame.first_sample > 0u { sum = film[at].xyz; }
    counts = vec4<u32>(0u);
    for (var k = 0u; k < frame.sample_count; k++) {
        let colour = radiance(pixel, frame.first_sample + k);
        // A light of absurd strength must not leave holes in the picture.
        if is_finite3(colour) { sum += max(colour, vec3<f32>(0.0)); }
    }
    film[at] = vec4<f32>(sum, 0.0);
    for (var k = 0u; k < 4u; k++) { atomicAdd(&counters[k], counts[k]); }
}
