// A box of smoke: hides what is in and behind it by the law of Beer and Lambert, along the part of the ray that is in
// the box and in front of the scene. Drawn by its far sides, so that it is seen from inside too. Boxes that overlap
// multiply what they let through, in any order.

#import bevy_pbr::forward_io::VertexOutput
#import bevy_pbr::mesh_view_bindings::view
#import bevy_pbr::view_transformations::{frag_coord_to_ndc, position_ndc_to_world}
#ifdef DEPTH_PREPASS
#import bevy_pbr::prepass_utils::prepass_depth
#endif

struct Smoke {
    // From the world to a cube of side 1 around the origin.
    to_box: mat4x4<f32>,
    color: vec4<f32>,
    // In 1/m.
    extinction: f32,
};

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> smoke: Smoke;

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let camera = view.world_position;
    let direction = normalize(in.world_position.xyz - camera);
    let start = (smoke.to_box * vec4(camera, 1.0)).xyz;
    let along = (smoke.to_box * vec4(direction, 0.0)).xyz;
    let one = (-0.5 - start) / along;
    let other = (0.5 - start) / along;
    let near = min(one, other);
    let far = max(one, other);
    let enters = max(max(near.x, near.y), max(near.z, 0.0));
    var leaves = min(far.x, min(far.y, far.z));
#ifdef DEPTH_PREPASS
    let depth = prepass_depth(in.position, 0u);
    // 0 is infinitely far.
    if depth > 0.0 {
        let ndc = frag_coord_to_ndc(vec4(in.position.xy, depth, 1.0));
        leaves = min(leaves, distance(position_ndc_to_world(ndc), camera));
    }
#endif
    let opacity = 1.0 - exp(-smoke.extinction * max(leaves - enters, 0.0));
    return vec4(smoke.color.rgb, opacity);
}
