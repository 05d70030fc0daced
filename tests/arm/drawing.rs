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
