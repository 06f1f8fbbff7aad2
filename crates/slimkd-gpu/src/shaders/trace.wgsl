// Rays in, hits out. Twin: twin/mod.rs.

@group(1) @binding(0) var<uniform> batch: vec4<u32>; // rays, any hit
@group(1) @binding(1) var<storage, read> rays: array<f32>;
@group(1) @binding(2) var<storage, read_write> hits: array<vec4<u32>>;

@compute @workgroup_size(128)
fn trace_rays(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.x { return; }
    let at = 8u * id.x;
    let origin = vec3<f32>(rays[at], rays[at + 1u], rays[at + 2u]);
    let direction = vec3<f32>(rays[at + 3u], rays[at + 4u], rays[at + 5u]);
    let hit = trace(Ray(origin, direction, rays[at + 6u], rays[at + 7u]), batch.y == 1u);
    hits[id.x] = vec4<u32>(bitcast<u32>(hit.t), bitcast<u32>(hit.u), bitcast<u32>(hit.v), hit.triangle);
}
