//! What a URDF may say, and how its faults are named.

use proptest::prelude::*;

use super::*;

const ARM: &str = include_str!("../../../sample-logs/arm/arm.urdf");

fn read(text: &str, tool: Option<&str>) -> Result<Chain, String> {
    Chain::from_urdf(text, "a.urdf", tool).map_err(|error| error.to_string())
}

fn fault(from: &str, to: &str) -> String {
    let text = ARM.replacen(from, to, 1);
    assert_ne!(text, ARM);
    read(&text, None).unwrap_err()
}

#[test]
fn the_sample_files_say_that_their_numbers_are_assumed() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/arm");
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        assert!(text.contains("ASSUM"));
    }
    assert_eq!(sample().chain.tool_name(), "tool");
}

#[test]
fn faults_name_element_found_and_expected() {
    let cases = [
        (
            r#"child link="link2""#,
            r#"child link="link9""#,
            r#"<joint "J2"> <child>: found link9, expected a link"#,
        ),
        (
            r#"child link="link3""#,
            r#"child link="link2""#,
            r#"<link "link2">: found the joints "J2" and "J3""#,
        ),
        (r#"name="J2""#, r#"name="J1""#, r#"<joint "J1">: found it twice"#),
        (r#"<link name="tool"/>"#, r#"<link name="base"/>"#, r#"<link "base">: found it twice"#),
        (r#"type="revolute""#, r#"type="planar""#, r#"<joint "J1">: found the type planar, expected rev"#),
        (r#"xyz="0 1 0"/><limit"#, r#"xyz="0 0 0"/><limit"#, r#"<joint "J1"> <axis>: found [0.0, 0.0, 0.0]"#),
        (r#"lower="0.349066""#, r#"lower="9""#, r#"<joint "J1"> <limit>: found lower 9 and upper 1.658063"#),
        (
            r#"lower="0.349066""#,
            r#"lower="-170""#,
            "found lower -170 and upper 1.658063, 27 turns, expected radians: degrees times",
        ),
        (r#"mass value="55.0""#, r#"mass value="-55""#, r#"<link "link1"> <inertial>: found mass -55 kg"#),
        (
            r#"velocity="0.436332""#,
            r#"velocity="-1""#,
            r#"<joint "J1"> <limit>: found velocity -1, expected"#,
        ),
        (r#"mass value="55.0""#, r#"mass value="${m}""#, r#""${m}" is not a number: this is xacro"#),
        (r#"xyz="1.2 0 0""#, r#"xyz="inf 0 0""#, r#"<joint "J2"> <origin>: found xyz [inf, 0.0, 0.0]"#),
        (r#"xyz="1.2 0 0""#, r#"xyz="1.2 0""#, "cannot be read"),
        ("</robot>", "", "cannot be read"),
        (
            r#"parent link="base""#,
            r#"parent link="tool""#,
            r#"<robot>: found a ring of joints, to which nothing leads from "base": link1,"#,
        ),
        (
            r#"<link name="base"/>"#,
            r#"<link name="base"/><xacro:include filename="boom.xacro"/>"#,
            "<xacro:include>: found xacro, which is no URDF yet",
        ),
        (r#"<link name="base"/>"#, r#"<link name="base"/><link name="moon"/>"#, "found 2: base, moon"),
    ];
    for (from, to, expected) in cases {
        let found = fault(from, to);
        assert!(found.starts_with("a.urdf") && found.contains(expected), "{found}\nnot {expected}");
    }
}

#[test]
fn a_range_in_millimetres_of_a_joint_that_slides_is_refused() {
    let (before, after) = SLIDING.split_once(r#"name="q2""#).unwrap();
    let text = format!(r#"{before}name="q2"{}"#, after.replacen(r#"upper="2.5""#, r#"upper="1200""#, 1));
    let found = read(&text, None).unwrap_err();
    assert_eq!(
        found,
        r#"a.urdf: <joint "q2"> <limit>: found lower -2.5 and upper 1200, expected metres: millimetres times 0.001"#
    );
}

#[test]
fn a_loop_beside_the_base_is_found() {
    let turn = |name: &str, from: &str, to: &str| {
        format!(
            r#"<joint name="{name}" type="continuous"><parent link="{from}"/><child link="{to}"/></joint>"#
        )
    };
    let links: String = ["a", "b", "c", "d"].map(|name| format!(r#"<link name="{name}"/>"#)).concat();
    let text = format!(
        r#"<robot name="r">{links}{}{}{}</robot>"#,
        turn("1", "a", "b"),
        turn("2", "c", "d"),
        turn("3", "d", "c")
    );
    assert!(read(&text, Some("b")).is_ok());
    assert!(read(&text, Some("d")).unwrap_err().contains("loop"));
}

#[test]
fn several_possible_tools_are_named() {
    let found = read(SPATIAL, None).unwrap_err();
    assert_eq!(
        found,
        "a.urdf: the tool could be any of link5, camera, tool; name one (in a task: tool = \"link5\")"
    );
    let framed = SPATIAL.replace(
        "</robot>",
        r#"<link name="frame"/><joint name="frame_joint" type="fixed"><parent link="base"/><child link="frame"/></joint></robot>"#,
    );
    let moved = read(&framed, None).unwrap_err();
    assert!(!moved.contains("frame") && moved.contains("camera, tool"), "{moved}");
    assert_eq!(read(SPATIAL, Some("tool")).unwrap().joint_count(), 7);
    assert!(read(SPATIAL, Some("nose")).unwrap_err().contains("tool: found nose"));
    assert!(read(SPATIAL, Some("camera")).unwrap_err().contains("moving joint beside the path"));
    assert!(read(SPATIAL, Some("base")).unwrap_err().contains("no joint that moves"));
}

#[test]
fn the_fingers_of_a_gripper_are_held_and_an_arm_beside_is_refused() {
    let joint = |name: &str, kind: &str, from: &str, to: &str| {
        let range = r#"<limit lower="-1" upper="1" effort="9" velocity="1"/>"#;
        format!(
            r#"<joint name="{name}" type="{kind}"><parent link="{from}"/><child link="{to}"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>{range}</joint>"#
        )
    };
    let mass =
        r#"<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let links: String = ["base", "l1", "hand", "f1", "f2"]
        .map(|name| format!(r#"<link name="{name}">{mass}</link>"#))
        .concat();
    let arm = joint("j1", "revolute", "base", "l1") + &joint("j2", "revolute", "l1", "hand");
    let fingers = joint("g1", "prismatic", "hand", "f1") + &joint("g2", "revolute", "hand", "f2");
    let text = format!(r#"<robot name="r">{links}{arm}{fingers}</robot>"#);
    assert_eq!(
        read(&text, None).unwrap_err(),
        "a.urdf: the tool could be any of hand, f1, f2; name one (in a task: tool = \"hand\")"
    );
    let held = read(&text, Some("hand")).unwrap();
    let fixed = text.replace("prismatic", "fixed").replace(r#""g2" type="revolute""#, r#""g2" type="fixed""#);
    assert_eq!(held.joint_count(), 2);
    assert_eq!(
        format!("{:?}", held.load(None)),
        format!("{:?}", read(&fixed, Some("hand")).unwrap().load(None))
    );
    let beside = text
        .replace(r#"<parent link="hand"/><child link="f2"/>"#, r#"<parent link="l1"/><child link="f2"/>"#);
    assert!(read(&beside, Some("hand")).unwrap_err().contains("moving joint beside"), "{beside}");
}

#[test]
fn nesting_and_size_are_bounded() {
    let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
    assert_eq!(read(&deep, None).unwrap_err(), "a.urdf: 100000 nested elements, at most 32 are read");
    let long = " ".repeat(5 << 20);
    assert!(read(&long, None).unwrap_err().contains("bytes, at most"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_to_the_text_makes_it_panic(
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..40, "[<>/=\"' a-z0-9&;!?\\[\\]-]{0,12}"), 1..6),
        skew in any::<bool>(),
    ) {
        let mut text = if skew { SPATIAL } else { ARM }.to_owned();
        for (at, length, with) in cuts {
            let at = at.index(text.len());
            let end = (at + length).min(text.len());
            text.replace_range(at..end, &with);
        }
        for tool in [None, Some("tool")] {
            if let Ok(chain) = read(&text, tool) {
                let n = chain.joint_count();
                let _ = torque(&chain, None, &vec![0.3; n], &vec![0.1; n], &vec![0.2; n]);
            }
        }
    }

    #[test]
    fn no_text_makes_it_panic(text in "\\PC{0,200}") {
        let _ = read(&text, None);
    }
}
