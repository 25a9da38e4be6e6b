// Joints to lanes, and back. Behind the states stand constants of the joints of each world, and what controls make of the
// forces along the axes of all, both `[number][joint]`; the state has what they carry from step to step, joint by joint. The
// same joint of all worlds lies side by side, as all of a run are solved side by side.

fn put_joint(field: u32, i: u32, x: f32) {
    joints[field * plan.joints + i] = x;
}
fn given(number: u32, i: u32) -> f32 {
    let world = plan.given + i % plan.worlds * plan.given_numbers;
    return state[world + number * plan.own_joints + i / plan.worlds];
}
fn acting(number: u32, i: u32) -> f32 {
    return state[plan.acting + number * plan.joints + i];
}
fn carried(i: u32) -> u32 {
    let world = i % plan.worlds * plan.state_numbers;
    return world + plan.tied + whole[plan.ties + i / plan.worlds] * JOINT_CARRIED;
}
fn joint_body(i: u32, side: u32) -> u32 {
    let body = whole[plan.joint_seats + side * plan.own_joints + i / plan.worlds];
    return row_of(i % plan.worlds, body);
}

@compute @workgroup_size(64)
fn load_joints(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= plan.joints) {
        return;
    }
    for (var field = 0u; field < JOINT_CONSTANTS; field++) {
        put_joint(field, i, given(field, i));
    }
    let source = carried(i);
    for (var field = 0u; field < JOINT_CARRIED; field++) {
        // What a step gives is summed from its beginning.
        let begins = field >= JOINT_SUM && is_first();
        put_joint(JOINT_TARGET + field, i, select(state[source + field], 0.0, begins));
    }
    var number = JOINT_CONSTANTS;
    for (var axis = 0u; axis < AXES; axis++) {
        for (var field = 0u; field < AXIS_CONSTANTS; field++) {
            put_joint(AXIS + axis * AXIS_WIDTH + field, i, given(number, i));
            number++;
        }
        put_joint(AXIS + axis * AXIS_WIDTH + AXIS_ACTS, i, acting(axis * ACTING, i));
        put_joint(AXIS + axis * AXIS_WIDTH + AXIS_FORCE, i, acting(axis * ACTING + ACTING_FORCE, i));
        put_joint(AXIS + axis * AXIS_WIDTH + AXIS_GOAL, i, acting(axis * ACTING + ACTING_GOAL, i));
    }
    for (var field = 0u; field < plan.law_numbers; field++) {
        put_joint(LAW + field, i, given(number + field, i));
    }
    for (var law = 0u; law < plan.law_numbers / LAW_WIDTH; law++) {
        put_joint(LAW + law * LAW_WIDTH + LAW_FORCE, i, acting(AXES * ACTING + law, i));
    }
}

@compute @workgroup_size(64)
fn store_joints(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= plan.joints || !runs_in(i % plan.worlds)) {
        return;
    }
    for (var field = 0u; field < JOINT_CARRIED; field++) {
        state[carried(i) + field] = joints[(JOINT_TARGET + field) * plan.joints + i];
    }
}
