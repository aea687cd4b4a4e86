//! Which bodies must be solved together.

/// What is solved together: indices of pairs and of joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Members {
    pub(crate) pairs: Vec<usize>,
    pub(crate) joints: Vec<usize>,
}

/// A joint between two bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IslandJoint {
    pub(crate) bodies: [usize; 2],
    /// Whether it has motors.
    pub(crate) is_driven: bool,
}

/// Groups `pairs` of body indices, and the `joints` between bodies, into islands: what shares a movable body is in one island. Where
/// neither a pair nor a motor is, there is none.
///
/// Islands come in the order of their first pair, then in that of their first motor; pairs and joints in their own order, so the result
/// depends on the input only.
pub(crate) fn islands(pairs: &[[usize; 2]], joints: &[IslandJoint], movable: &[bool]) -> Vec<Members> {
    let mut parent: Vec<usize> = (0..movable.len()).collect();
    let joined = pairs.iter().copied().chain(joints.iter().map(|joint| joint.bodies));
    for [a, b] in joined.filter(|[a, b]| movable[*a] && movable[*b]) {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b)] = a.min(b);
    }
    let mut island_of = vec![usize::MAX; movable.len()];
    let mut islands: Vec<Members> = Vec::new();
    let mut root_of = |[a, b]: [usize; 2]| root(&mut parent, if movable[a] { a } else { b });
    let driven = joints.iter().filter(|joint| joint.is_driven);
    for bodies in pairs.iter().copied().chain(driven.map(|joint| joint.bodies)) {
        let body = root_of(bodies);
        if island_of[body] == usize::MAX {
            island_of[body] = islands.len();
            islands.push(Members::default());
        }
    }
    for (index, bodies) in pairs.iter().enumerate() {
        islands[island_of[root_of(*bodies)]].pairs.push(index);
    }
    for (index, joint) in joints.iter().enumerate() {
        if let Some(island) = islands.get_mut(island_of[root_of(joint.bodies)]) {
            island.joints.push(index);
        }
    }
    islands
}

/// Representative of `i`, with path halving.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_bodies_do_not_join_islands() {
        let movable = [false, true, true, true, true];
        let pairs = [[0, 1], [0, 2], [2, 3], [0, 4], [1, 4]];
        let of_pairs = |pairs: Vec<usize>| Members { pairs, joints: Vec::new() };
        assert_eq!(islands(&pairs, &[], &movable), vec![of_pairs(vec![0, 3, 4]), of_pairs(vec![1, 2])]);
    }

    #[test]
    fn joints_join_islands_and_make_some_where_they_are_driven() {
        let movable = [false, true, true, true, true, true];
        let joints = |is_driven: bool| {
            [[0, 1], [1, 2], [0, 4], [4, 5]]
                .map(|bodies| IslandJoint { bodies, is_driven: is_driven && bodies[0] == 4 })
        };
        let members =
            |pairs: &[usize], joints: &[usize]| Members { pairs: pairs.to_vec(), joints: joints.to_vec() };
        let mut expected = vec![members(&[0, 1], &[0, 1]), members(&[2], &[])];
        let pairs = [[0, 1], [2, 0], [3, 0]];
        assert_eq!(islands(&pairs, &joints(false), &movable), expected);
        expected.push(members(&[], &[2, 3]));
        assert_eq!(islands(&pairs, &joints(true), &movable), expected);
    }
}
