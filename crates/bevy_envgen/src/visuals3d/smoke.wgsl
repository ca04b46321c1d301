// A box of smoke: hides what is in and behind it by the law of Beer and Lambert, along the part of the ray that is in
// the box and in front of the scene. Drawn by its far sides, so that it is seen from inside too. Boxes that overlap
// multiply what they let through, in any order.

#import bevy_pbr::forward_io::VertexOutput
#import bevy_pbr::mesh_functions::{get_local_from_world, get_tag}
#import bevy_pbr::mesh_view_bindings::view
#import bevy_pbr::view_transformations::{frag_coord_to_ndc, position_ndc_to_world}
#ifdef DEPTH_PREPASS
#import bevy_pbr::prepass_utils::prepass_depth
#endif

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> color: vec4<f32>;

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    var origin = view.world_position;
    var direction = normalize(in.world_position.xyz - origin);
    // In an orthographic view all rays have the direction of the camera. They start on the near plane.
    if view.clip_from_view[3].w == 1.0 {
        origin = position_ndc_to_world(vec3(frag_coord_to_ndc(in.position).xy, 1.0));
        direction = -normalize(view.world_from_view[2].xyz);
    }
    // A cube of side 1 around the origin.
    let to_box = get_local_from_world(in.instance_index);
    let start = (to_box * vec4(origin, 1.0)).xyz;
    let along = (to_box * vec4(direction, 0.0)).xyz;
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
        leaves = min(leaves, distance(position_ndc_to_world(ndc), origin));
    }
#endif
    // As `tag` in smoke.rs packs them.
    let tag = get_tag(in.instance_index);
    let root = f32(tag >> 12u) / 8192.0;
    let light = f32(tag & 4095u) / 4095.0;
    let opacity = 1.0 - exp(-root * root * max(leaves - enters, 0.0));
    return vec4(light * color.rgb, opacity);
}
