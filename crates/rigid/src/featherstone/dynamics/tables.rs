//! What the kernels of dynamics read and write beyond the solver's tables.
//!
//! The *path* of a degree of freedom or of a body is every degree of freedom
//! between it and the world: those that move it. Paths are written out as lists,
//! so that walking up the tree is a plain loop in every reading of a kernel.

use crate::featherstone::tables::{Tables, body_link, node_link};
use crate::tables::Filler;
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Input, Output};

/// Fields of [`DynamicsTables::dof_links`].
pub(crate) mod dof_link {
    /// Row of the node it moves.
    pub const NODE: usize = 0;
    pub const PATH_BEGIN: usize = 1;
    pub const PATH_END: usize = 2;
    /// Row of its entry on the diagonal of the mass matrix.
    pub const DIAGONAL: usize = 3;
    pub const WIDTH: usize = 4;
}

/// Fields of [`DynamicsTables::path_links`].
pub(crate) mod path_link {
    /// A degree of freedom j of the path of i.
    pub const DOF: usize = 0;
    /// Row of the entry (i, j) of the mass matrix.
    pub const ENTRY: usize = 1;
    /// Row of the entry (j, i).
    pub const MIRROR: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Fields of [`DynamicsTables::body_links`].
pub(crate) mod body_path {
    /// Row of the body in the solver's table.
    pub const ROW: usize = 0;
    pub const PATH_BEGIN: usize = 1;
    pub const PATH_END: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Where the numbers of dynamics lie, behind those of the solver. n is the number
/// of degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicsTables {
    /// Accelerations that inverse dynamics is asked about [m/s² or rad/s²], n.
    pub acceleration: Table<Input>,
    /// The point that a Jacobian is asked about [m], in the body's frame.
    pub point: Table<Input, 3>,
    /// The mass matrix, row by row, n².
    pub mass_matrix: Table<Output>,
    /// Forces along the degrees of freedom [N or N·m], n.
    pub force: Table<Output>,
    /// Columns of a Jacobian: angular, linear; n.
    pub jacobian: Table<Output, 6>,
    pub(crate) dof_links: Links<{ dof_link::WIDTH }>,
    pub(crate) path_links: Links<{ path_link::WIDTH }>,
    pub(crate) body_links: Links<{ body_path::WIDTH }>,
    pub(crate) input_length: usize,
    pub(crate) output_length: usize,
}

impl DynamicsTables {
    /// Lays the tables out behind the solver's and appends the paths to its links.
    pub(crate) fn new(t: &Tables, links: &mut Vec<u32>) -> Self {
        let paths = Paths::new(t, links);
        let entries: usize = paths.of_dof.iter().map(Vec::len).sum();
        let (mut input, mut output) = (t.input.length, t.output.length);
        let mut end = links.len();
        let tables = Self {
            acceleration: Table::place(&mut input, t.dofs),
            point: Table::place(&mut input, 1),
            mass_matrix: Table::place(&mut output, t.dofs * t.dofs),
            force: Table::place(&mut output, t.dofs),
            jacobian: Table::place(&mut output, t.dofs),
            dof_links: Links::place(&mut end, t.dofs),
            path_links: Links::place(&mut end, entries),
            body_links: Links::place(&mut end, t.bodies),
            input_length: input,
            output_length: output,
        };
        links.resize(end, 0);
        let mut filler = Filler {
            parameters: Vec::new(),
            links: std::mem::take(links),
        };
        tables.fill(t, &paths, &mut filler);
        *links = filler.links;
        tables
    }

    fn fill(&self, t: &Tables, paths: &Paths, f: &mut Filler) {
        let mut row = 0;
        let mut ranges = Vec::with_capacity(t.dofs);
        for (i, path) in paths.of_dof.iter().enumerate() {
            let range = (row, row + path.len());
            f.link(self.dof_links, i, dof_link::NODE, paths.node_of_dof[i]);
            f.link(self.dof_links, i, dof_link::PATH_BEGIN, range.0);
            f.link(self.dof_links, i, dof_link::PATH_END, range.1);
            f.link(self.dof_links, i, dof_link::DIAGONAL, i * t.dofs + i);
            for &j in path {
                f.link(self.path_links, row, path_link::DOF, j);
                f.link(self.path_links, row, path_link::ENTRY, i * t.dofs + j);
                f.link(self.path_links, row, path_link::MIRROR, j * t.dofs + i);
                row += 1;
            }
            ranges.push(range);
        }
        for (body, &(row, last)) in paths.of_body.iter().enumerate() {
            let (begin, end) = last.map_or((0, 0), |dof| ranges[dof]);
            f.link(self.body_links, body, body_path::ROW, row);
            f.link(self.body_links, body, body_path::PATH_BEGIN, begin);
            f.link(self.body_links, body, body_path::PATH_END, end);
        }
    }
}

/// The paths of a tree, from the solver's links.
struct Paths {
    /// Per degree of freedom: its path, itself last.
    of_dof: Vec<Vec<usize>>,
    node_of_dof: Vec<usize>,
    /// Per body: its row, and the last degree of freedom that moves it.
    of_body: Vec<(usize, Option<usize>)>,
}

impl Paths {
    fn new(t: &Tables, links: &[u32]) -> Self {
        let node = |n: usize, field: usize| links[t.node_links.at(n, field)] as usize;
        let last_of = |n: usize| {
            let moved = n >= t.trees;
            moved.then(|| node(n, node_link::DOF_BEGIN) + node(n, node_link::DOF_COUNT) - 1)
        };
        let mut of_dof = vec![Vec::new(); t.dofs];
        let mut node_of_dof = vec![0; t.dofs];
        for n in t.trees..t.trees + t.nodes {
            let above = last_of(node(n, node_link::PARENT));
            let mut path = above.map_or_else(Vec::new, |dof| of_dof[dof].clone());
            let begin = node(n, node_link::DOF_BEGIN);
            for dof in begin..begin + node(n, node_link::DOF_COUNT) {
                path.push(dof);
                of_dof[dof].clone_from(&path);
                node_of_dof[dof] = n;
            }
        }
        let mut of_body = vec![(0, None); t.bodies];
        for row in 0..t.bodies {
            let link = |field: usize| links[t.body_links.at(row, field)] as usize;
            of_body[link(body_link::BODY)] = (row, last_of(link(body_link::NODE)));
        }
        Self {
            of_dof,
            node_of_dof,
            of_body,
        }
    }
}
