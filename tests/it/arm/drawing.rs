//! What is drawn of an arm: solids on its links, and descriptions that read back.

use hydrotrace::arm::{Chain, GHOST, Pose, Solid};

use super::{sample, spatial};

fn apart_m(a: &Pose, b: &Pose) -> f64 {
    (a.translation.vector - b.translation.vector).norm()
}

#[test]
fn a_description_reads_back_as_the_same_arm_and_the_ghost_as_one_beside_it() {
    for chain in [sample().chain, spatial()] {
        let tool = chain.tool_name().to_owned();
        let read = Chain::from_urdf(&chain.description().unwrap(), "own", Some(&tool)).unwrap();
        let ghost_tool = format!("{GHOST}{tool}");
        let ghost =
            Chain::from_urdf(&chain.ghost_description().unwrap(), "ghost", Some(&ghost_tool)).unwrap();
        let q: Vec<f64> = (0..chain.joint_count()).map(|j| 0.3 + 0.1 * j as f64).collect();
        for (own, (a, b)) in
            chain.link_poses(&q).iter().zip(read.link_poses(&q).iter().zip(ghost.link_poses(&q)))
        {
            assert!(apart_m(own, a) < 1e-9 && apart_m(own, &b) < 1e-9);
        }
        assert!(ghost.link_names().all(|name| name.starts_with(GHOST)));
        assert!(ghost.joints().iter().all(|joint| joint.name.starts_with(GHOST)));
        assert_eq!(read.shapes(&[]).len(), chain.shapes(&[]).len());
        let solid = |chain: &Chain| match chain.shapes(&[]).first().unwrap().solid {
            Solid::Block(edges_m) => edges_m[1],
            Solid::Cylinder { radius_m, .. } | Solid::Ball(radius_m) => radius_m,
        };
        assert!(solid(&ghost) > solid(&read), "the two would show at one place");
    }
}

#[test]
fn an_arm_without_solids_is_drawn_as_blocks_that_end_where_the_next_link_begins() {
    let chain = sample().chain;
    let poses = chain.link_poses(&[0.5; 6]);
    for shape in chain.shapes(&[]) {
        let Solid::Block([length_m, ..]) = shape.solid else { continue };
        let ends_m = [-0.5, 0.5].map(|share| {
            (poses[shape.link] * shape.place * nalgebra::Point3::new(share * length_m, 0.0, 0.0)).coords
        });
        assert!((ends_m[0] - poses[shape.link].translation.vector).norm() < 1e-9);
        assert!((ends_m[1] - poses[shape.link + 1].translation.vector).norm() < 1e-9);
    }
    assert_eq!(chain.shapes(&[]).iter().filter(|s| matches!(s.solid, Solid::Cylinder { .. })).count(), 6);
}

const DRESSED: &str = r#"<robot name="r">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="arm"><visual><geometry><mesh filename="package://none/arm.stl"/></geometry></visual></link>
  <joint name="f" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0"/></joint>
  <link name="tool"/>
  <joint name="s" type="fixed"><parent link="arm"/><child link="side"/><origin xyz="0 2 0"/></joint>
  <link name="side"><visual><origin xyz="0 0 3"/><geometry><sphere radius="0.1"/></geometry>
    <material name="red"/></visual></link>
</robot>"#;

#[test]
fn own_solids_are_kept_with_their_colour_on_fixed_branches_too_and_meshes_are_left_to_others() {
    let chain = Chain::from_urdf(DRESSED, "r.urdf", Some("tool")).unwrap();
    let shapes = chain.shapes(&[]);
    assert_eq!(shapes.len(), 1);
    assert_eq!((shapes[0].link, shapes[0].solid), (1, Solid::Ball(0.1)));
    assert_eq!(shapes[0].rgba, [1.0, 0.0, 0.0, 1.0]);
    let place_m = shapes[0].place.translation.vector;
    assert!((place_m - nalgebra::Vector3::new(0.0, 2.0, 3.0)).norm() < 1e-12);
    let text = chain.description().unwrap();
    assert!(text.contains("package://none/arm.stl") && !text.contains("<box"), "{text}");
}

#[test]
fn a_mesh_that_is_drawn_needs_no_stand_in_and_one_that_is_not_has_the_blocks_of_its_link() {
    let only = DRESSED.replace("sphere radius=\"0.1\"", "mesh filename=\"b.obj\" scale=\"0.001 1 1\"");
    let chain = Chain::from_urdf(&only, "r.urdf", Some("tool")).unwrap();
    let meshes = chain.meshes();
    let uris: Vec<&str> = meshes.iter().map(|mesh| mesh.uri.as_str()).collect();
    assert_eq!(uris, ["package://none/arm.stl", "b.obj"]);
    assert_eq!((meshes[0].scale, meshes[1].scale), ([1.0; 3], [0.001, 1.0, 1.0]));
    assert_eq!((meshes[0].rgba, meshes[1].rgba), (None, Some([1.0, 0.0, 0.0, 1.0])));
    assert_eq!(meshes[1].place.translation.vector, nalgebra::Vector3::new(0.0, 2.0, 3.0));
    assert!(chain.shapes(&meshes).is_empty());
    // Both ride on one link: either shows where it is.
    assert!(chain.shapes(&meshes[..1]).is_empty());
    assert!(chain.shapes(&[]).iter().any(|shape| shape.link == 1));
    // The base now shows something, so only the link whose meshes are missing has blocks.
    let based = only.replace(
        r#"<link name="base"/>"#,
        r#"<link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>"#,
    );
    let chain = Chain::from_urdf(&based, "r.urdf", Some("tool")).unwrap();
    assert_eq!(chain.shapes(&meshes).len(), 1);
    let beside: Vec<usize> = chain.shapes(&[]).iter().skip(1).map(|shape| shape.link).collect();
    assert!(!beside.is_empty() && beside.iter().all(|link| *link == 1), "{beside:?}");
}

/// A robot with a sliding torso, two arms and a hand.
const ROBOT: &str = r#"<robot name="r">
  <link name="base"/><link name="torso"/><link name="left_1"/><link name="left_2"/>
  <link name="right_1"/><link name="right_2"/><link name="flange"/><link name="hand"/>
  <joint name="left_a" type="revolute"><parent link="torso"/><child link="left_1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="torso"/><origin xyz="0 0 2"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
  <joint name="left_b" type="revolute"><parent link="left_1"/><child link="left_2"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="right_a" type="revolute"><parent link="torso"/><child link="right_1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="right_b" type="continuous"><parent link="right_1"/><child link="right_2"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="f" type="fixed"><parent link="right_2"/><child link="flange"/><origin xyz="1 0 0"/></joint>
  <joint name="finger" type="revolute"><parent link="flange"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"#;

#[test]
fn of_a_robot_the_arm_that_the_joints_move_is_read_and_all_else_stands_still() {
    assert!(Chain::from_urdf(ROBOT, "r.urdf", None).is_err());
    let (chain, still) =
        Chain::of_joints(ROBOT, "r.urdf", &["right_b", "lift", "left_a", "right_a"]).unwrap();
    let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["lift", "right_a", "right_b"], "the longer arm, in its own order");
    assert_eq!((chain.tool_name(), still), ("hand", Vec::new()));
    let poses = chain.link_poses(&[0.5, std::f64::consts::FRAC_PI_2, 0.0]);
    let tool_m = poses.last().unwrap().translation.vector;
    assert!((tool_m - nalgebra::Vector3::new(0.0, 2.0, 2.5)).norm() < 1e-12, "{tool_m}");

    let (chain, still) = Chain::of_joints(ROBOT, "r.urdf", &["left_b"]).unwrap();
    assert_eq!((chain.joint_count(), still), (1, vec!["left_a".to_owned(), "lift".to_owned()]));
    for none in [&[][..], &["other"]] {
        assert!(Chain::of_joints(ROBOT, "r.urdf", none).is_err());
    }
}

#[test]
fn of_a_plain_arm_all_of_whose_joints_are_named_the_same_arm_is_read() {
    for chain in [sample().chain, spatial(), super::sliding()] {
        let text = chain.description().unwrap();
        let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
        let (read, still) = Chain::of_joints(&text, "own", &names).unwrap();
        assert!(still.is_empty());
        let q = vec![0.4; names.len()];
        for (a, b) in chain.link_poses(&q).iter().zip(read.link_poses(&q)) {
            assert!(apart_m(a, &b) < 1e-9);
        }
    }
}
