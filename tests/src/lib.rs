//! What the workspace tests share: the built program, scenes, scratch folders, and readers of the
//! files of a run.
//!
//! The tests start the program `sph` as a user does and look at what it leaves: exit codes,
//! messages, files. `SPH_PROGRAM` names the program (`target/release/sph` when unset), and
//! `SPH_MPI_PROGRAM` the one built with the feature `mpi`; without the latter the tests under
//! `mpirun` say that they were skipped. `./test` at the root of the workspace builds both and sets
//! the variables.
#![forbid(unsafe_code)]

mod book;
mod inputs;
mod message;
mod page;
mod program;
mod python;
mod results;
mod run;
mod running;
mod scenes;
mod series;
mod stl;
mod table;
mod vtu;
mod whole;

pub use book::{Chapter, Fence, anchor, chapters};
pub use inputs::Input;
pub use message::Message;
pub use page::Page;
pub use program::{mpi_program, program, skipped, workspace};
pub use python::python_with;
pub use results::{Results, copy_folder};
pub use run::Run;
pub use running::{Outcome, Running};
pub use scenes::{Reduced, SHIPPED, SMALL, line_of, scene, write_scene};
pub use series::{Entry, read_series};
pub use stl::BoxMesh;
pub use table::{Table, read_table};
pub use vtu::{Array, Vtu, read_vtu};
pub use whole::{assert_finite, assert_whole};
