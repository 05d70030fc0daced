//! Where in its message a number lay: for programs that read the log themselves.

use super::{MAX_JOINTS, Table};

/// Places of fields among the values of each group.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct InterfacePlaces {
    /// `[group][field]`.
    by_group: Vec<Vec<Option<usize>>>,
    /// Whether messages differ in them.
    moved: bool,
}

impl InterfacePlaces {
    pub(super) fn see(&mut self, group: usize, places: &[Option<usize>]) {
        match self.by_group.get(group) {
            Some(known) => self.moved |= known != places,
            None if group == self.by_group.len() && group < MAX_JOINTS => self.by_group.push(places.to_vec()),
            None => self.moved = true,
        }
    }

    pub(super) fn append(&mut self, other: &mut Self) {
        let theirs = std::mem::take(other);
        self.moved |= theirs.moved;
        for (group, places) in theirs.by_group.iter().enumerate() {
            self.see(group, places);
        }
    }
}

impl Table {
    /// Joints by their place in a message; `None` if messages differ in them.
    pub(in crate::log) fn joint_places(&self) -> Option<Vec<String>> {
        let names = &self.layout.names;
        if self.lists.apart || self.lists.changes() > 0 || self.too_many > 0 {
            return None;
        }
        let named = |(place, name): (usize, &String)| {
            let before = names[..place].iter().filter(|other| *other == name).count();
            if before == 0 { name.clone() } else { format!("{name}#{}", before + 1) }
        };
        Some(names.iter().enumerate().map(named).collect())
    }

    /// Place of a field among the values of the joint at a place; `None` if messages differ in it.
    pub(in crate::log) fn interface_place(&self, joint: usize, field: usize) -> Option<usize> {
        let places = self.interfaces.by_group.get(joint).filter(|_| !self.interfaces.moved)?;
        places.get(field).copied().flatten()
    }
}
