//! The fields of known message types that are joint positions, and which are plan or measurement.

use super::slot;
use crate::log::{
    decode::{Slot, Want, shape_at},
    options::Selector,
    schema::{Definition, Shape, plain_name},
};

/// The meaning of a field for a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::log) enum Role {
    Planned,
    Measured,
    /// Depends on the topic.
    Either,
    /// Another signal, read because the caller named it.
    Beside,
}

/// A field of a table: one number a joint and message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) struct Field {
    /// Path in the message, or name of the interface.
    pub(in crate::log) path: String,
    pub(in crate::log) role: Role,
    /// Index of the field that holds the velocity of this position; `None` for velocities and
    /// for positions without.
    pub(in crate::log) velocity: Option<usize>,
    /// Whether this is a velocity.
    pub(in crate::log) is_velocity: bool,
}

/// How messages of a type are laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::log) enum Form {
    /// Names once, arrays in parallel.
    #[default]
    Table,
    /// A list of joints, each with its name and numbers.
    Groups,
    /// Names once, and for each a list of named values.
    Interfaces,
    /// Values whose names come in another topic, joined by a version number.
    Versioned,
    /// The names for [`Form::Versioned`].
    VersionedNames,
    /// Whole trajectories.
    Plans,
    /// Poses of a frame.
    Poses,
    /// Poses that say of which frame they are, and in which.
    Transforms,
}

/// How to read one type of message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) struct Spec {
    pub(in crate::log) form: Form,
    pub(in crate::log) fields: Vec<Field>,
    pub(in crate::log) wants: Vec<Want>,
    /// The joint whose only number a message may hold.
    pub(in crate::log) alone: Option<String>,
}

pub(in crate::log) const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
pub(in crate::log) const NANOSECONDS: [&str; 4] = ["nanosec", "nsec", "nsecs", "nanos"];
const STAMPS: [&str; 3] = ["header.stamp", "stamp", "timestamp"];
const NAMES: [&str; 3] = ["joint_names", "names", "name"];

/// What an element of a list calls the joint that it is of.
const ELEMENT_NAMES: [&str; 4] = ["name", "joint_name", "joint", "axis"];

/// How to read messages of this type, `None` if it holds no joints and `selectors` name none of
/// its fields; with speeds where plan or measurement depends on the topic, if they are wanted. Without a definition (JSON, Protobuf) every spelling is tried on each message.
pub(in crate::log) fn spec_for(
    type_name: &str,
    definition: Option<&Definition>,
    (selectors, speeds): (&[(Role, &Selector)], bool),
) -> Option<Spec> {
    let plain = plain_name(&type_name.replace('.', "/"));
    let mut builder = Builder {
        definition,
        speeds,
        spec: Spec { form: Form::Table, fields: Vec::new(), wants: Vec::new(), alone: None },
    };
    match plain.as_str() {
        "control_msgs/JointTrajectoryControllerState" | "control_msgs/FollowJointTrajectory_Feedback" => {
            builder.controller("");
        }
        "control_msgs/FollowJointTrajectory_FeedbackMessage" => builder.controller("feedback."),
        "sensor_msgs/JointState" => builder.position("position", "velocity", Role::Either),
        "std_msgs/Float64MultiArray" => builder.position("data", "", Role::Either),
        "trajectory_msgs/JointTrajectory" => builder.plans("", None),
        "moveit_msgs/RobotTrajectory" => builder.plans("joint_trajectory.", None),
        "moveit_msgs/DisplayTrajectory" => builder.plans("trajectory.joint_trajectory.", Some("trajectory")),
        "foxglove/JointStates" | "foxglove_msgs/JointStates" => {
            builder.spec.form = Form::Groups;
            builder.want("joints", slot::GROUP);
            builder.want("joints.name", slot::NAMES);
            builder.position("joints.position", "joints.velocity", Role::Either);
        }
        "control_msgs/DynamicJointState" => {
            builder.spec.form = Form::Interfaces;
            builder.want("joint_names", slot::NAMES);
            builder.want("interface_values", slot::GROUP);
            builder.want("interface_values.interface_names", slot::INTERFACES);
            builder.want("interface_values.values", slot::VALUES);
            builder.stamp_near("interface_values");
            builder.interface("position", speeds.then_some("velocity"), Role::Measured);
        }
        "geometry_msgs/PoseStamped" => builder.poses("", ["pose.position", "pose.orientation"], Role::Either),
        "foxglove/PoseInFrame" | "foxglove_msgs/PoseInFrame" => {
            builder.poses("", ["pose.position", "pose.orientation"], Role::Either);
            builder.want("frame_id", slot::PARENT);
        }
        "geometry_msgs/TransformStamped" => {
            builder.poses("", ["transform.translation", "transform.rotation"], Role::Either);
        }
        "geometry_msgs/PointStamped" => builder.poses("", ["point", "orientation"], Role::Either),
        "geometry_msgs/PoseWithCovarianceStamped" | "nav_msgs/Odometry" => {
            builder.poses("", ["pose.pose.position", "pose.pose.orientation"], Role::Either);
        }
        "nav_msgs/Path" => {
            builder.poses("poses", ["poses.pose.position", "poses.pose.orientation"], Role::Planned);
        }
        "tf2_msgs/TFMessage" | "tf/tfMessage" if !selectors.is_empty() => {
            let names = ["transforms.child_frame_id", "transforms.header.frame_id"];
            builder.transforms("transforms", names, "transforms.transform");
        }
        "foxglove/FrameTransforms" if !selectors.is_empty() => {
            let names = ["transforms.child_frame_id", "transforms.parent_frame_id"];
            builder.transforms("transforms", names, "transforms");
        }
        "pal_statistics_msgs/StatisticsNames" => {
            builder.spec.form = Form::VersionedNames;
            builder.want("names", slot::NAMES);
            builder.want("names_version", slot::VERSION);
        }
        "pal_statistics_msgs/StatisticsValues" => {
            builder.spec.form = Form::Versioned;
            builder.want("values", slot::VALUES);
            builder.want("names_version", slot::VERSION);
            builder.stamp_near("values");
        }
        _ => {}
    }
    for (role, selector) in selectors {
        builder.select(*role, selector);
    }
    (!builder.spec.wants.is_empty()).then_some(builder.spec)
}

struct Builder<'a> {
    definition: Option<&'a Definition>,
    speeds: bool,
    spec: Spec,
}

impl Builder<'_> {
    fn has(&self, path: &str) -> bool {
        self.definition.is_none_or(|definition| shape_at(definition, path).is_some())
    }

    fn want(&mut self, path: &str, slot: Slot) {
        if self.has(path) && !self.spec.wants.iter().any(|want| want.path == path) {
            self.spec.wants.push(Want { path: path.to_owned(), slot });
        }
    }

    fn controller(&mut self, prefix: &str) {
        for (point, role) in [
            ("reference", Role::Planned),
            ("desired", Role::Planned),
            ("feedback", Role::Measured),
            ("actual", Role::Measured),
        ] {
            let (position, velocity) =
                (format!("{prefix}{point}.positions"), format!("{prefix}{point}.velocities"));
            self.position(&position, if role == Role::Planned { &velocity } else { "" }, role);
        }
        self.want(&format!("{prefix}speed_scaling_factor"), slot::SPEED_SCALING);
    }

    fn plans(&mut self, prefix: &str, group: Option<&str>) {
        self.spec.form = Form::Plans;
        if let Some(group) = group {
            self.want(group, slot::GROUP);
        }
        self.stamp_near(&format!("{prefix}points"));
        self.want(&format!("{prefix}joint_names"), slot::NAMES);
        self.want(&format!("{prefix}points"), slot::POINT);
        for (name, slot) in [
            ("positions", slot::POSITIONS),
            ("velocities", slot::VELOCITIES),
            ("accelerations", slot::ACCELERATIONS),
        ] {
            self.want(&format!("{prefix}points.{name}"), slot);
        }
        let since = format!("{prefix}points.time_from_start");
        for leaf in SECONDS {
            self.want(&format!("{since}.{leaf}"), slot::POINT_SECOND);
        }
        for leaf in NANOSECONDS {
            self.want(&format!("{since}.{leaf}"), slot::POINT_NANOSECOND);
        }
    }

    /// Wants transforms, of the frames that the caller names: those of a robot are many.
    fn transforms(&mut self, group: &str, names: [&str; 2], at: &str) {
        self.pose(group, [&format!("{at}.translation"), &format!("{at}.rotation")]);
        self.spec.form = Form::Transforms;
        names.iter().zip([slot::CHILD, slot::PARENT]).for_each(|(path, slot)| self.want(path, slot));
    }

    /// Wants poses, a list of them where `group` names one.
    fn poses(&mut self, group: &str, paths: [&str; 2], role: Role) {
        self.spec.form = Form::Poses;
        self.interface("pose", None, role);
        self.pose(group, paths);
        self.want("header.frame_id", slot::PARENT);
        if !group.is_empty() {
            self.want(&format!("{group}.header.frame_id"), slot::PARENT);
        }
    }

    fn pose(&mut self, group: &str, [position, orientation]: [&str; 2]) {
        if !group.is_empty() {
            self.want(group, slot::GROUP);
        }
        let components = ["x", "y", "z"].map(|axis| format!("{position}.{axis}")).into_iter();
        let turns = ["x", "y", "z", "w"].map(|axis| format!("{orientation}.{axis}"));
        for (path, place) in components.chain(turns).zip(slot::FIELD..) {
            self.want(&path, place);
        }
        self.stamp_near(position);
    }

    fn interface(&mut self, position: &str, velocity: Option<&str>, role: Role) {
        let at = self.spec.fields.len();
        self.spec.fields.push(Field {
            path: position.to_owned(),
            role,
            velocity: velocity.map(|_| at + 1),
            is_velocity: false,
        });
        if let Some(velocity) = velocity {
            self.spec.fields.push(Field {
                path: velocity.to_owned(),
                role,
                velocity: None,
                is_velocity: true,
            });
        }
    }

    /// Adds a position field with its velocity, where the type has them, and finds the names and
    /// the stamp that go with it.
    fn position(&mut self, path: &str, velocity: &str, role: Role) {
        if self.spec.fields.iter().any(|field| field.path == path) || !self.has(path) {
            return;
        }
        let asked = self.speeds || role != Role::Either;
        let with_velocity = asked && !velocity.is_empty() && self.has(velocity);
        let at = self.spec.fields.len();
        let fields = 1 + usize::from(with_velocity);
        let Ok(first) = u8::try_from(at + fields) else { return };
        let slot = slot::FIELD.saturating_add(first - u8::from(with_velocity) - 1);
        self.interface(path, with_velocity.then_some(velocity), role);
        self.want(path, slot);
        if with_velocity {
            self.want(velocity, slot + 1);
        }
        self.near(
            path,
            &NAMES,
            slot::NAMES,
            |shape| matches!(shape, Shape::Sequence(of) if **of == Shape::Text),
        );
        self.stamp_near(path);
    }

    fn stamp_near(&mut self, path: &str) {
        for stamp in STAMPS {
            let seconds = SECONDS.map(|leaf| format!("{stamp}.{leaf}"));
            let nanoseconds = NANOSECONDS.map(|leaf| format!("{stamp}.{leaf}"));
            let number = |shape: &Shape<usize>| matches!(shape, Shape::Number(_));
            self.near(path, &seconds.each_ref().map(String::as_str), slot::SECOND, number);
            self.near(path, &nanoseconds.each_ref().map(String::as_str), slot::NANOSECOND, number);
        }
    }

    /// Wants the first of `leaves` that lies beside the path or beside one of its ancestors.
    fn near(&mut self, path: &str, leaves: &[&str], slot: Slot, fits: impl Fn(&Shape<usize>) -> bool) {
        if self.definition.is_some() && self.spec.wants.iter().any(|want| want.slot == slot) {
            return;
        }
        let mut ancestor = path;
        while !ancestor.is_empty() {
            ancestor = ancestor.rsplit_once('.').map_or("", |(parent, _)| parent);
            for leaf in leaves {
                let path =
                    if ancestor.is_empty() { (*leaf).to_owned() } else { format!("{ancestor}.{leaf}") };
                match self.definition {
                    None => self.want(&path, slot),
                    Some(definition) if shape_at(definition, &path).is_some_and(&fits) => {
                        self.want(&path, slot);
                        return;
                    }
                    Some(_) => {}
                }
            }
        }
    }

    /// Adds a field that the caller named.
    fn select(&mut self, role: Role, selector: &Selector) {
        let Some(path) = &selector.field else { return };
        if self.spec.fields.iter().any(|field| &field.path == path) {
            return;
        }
        if matches!(self.spec.form, Form::Interfaces | Form::Transforms) {
            self.interface(path, None, role);
        } else if matches!(self.spec.form, Form::Table | Form::Groups) {
            let velocity = match path.rsplit_once('.') {
                Some((parent, "positions")) => format!("{parent}.velocities"),
                Some((parent, "position")) => format!("{parent}.velocity"),
                _ => String::new(),
            };
            self.list_of(path);
            self.position(path, &velocity, role);
        }
    }

    /// A number within a list of structs is of as many joints, by the names in them.
    fn list_of(&mut self, path: &str) {
        let Some(definition) = self.definition else { return };
        let is_list = |path: &&str| match shape_at(definition, path) {
            Some(Shape::Sequence(of) | Shape::Array(_, of)) => matches!(**of, Shape::Struct(_)),
            _ => false,
        };
        let list = path.match_indices('.').map(|(at, _)| &path[..at]).find(is_list);
        let Some(list) = list else { return };
        self.spec.form = Form::Groups;
        self.want(list, slot::GROUP);
        let names = ELEMENT_NAMES.map(|name| format!("{list}.{name}"));
        let text = |path: &&String| matches!(shape_at(definition, path), Some(Shape::Text));
        if let Some(name) = names.iter().find(text) {
            self.want(name, slot::NAMES);
        }
    }
}
