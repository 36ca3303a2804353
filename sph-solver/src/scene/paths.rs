//! Files that a scene names: a scene from elsewhere must not reach for others than its own.

use super::document::Place;
use super::error::{ErrorKind, SceneError};
use super::located::At;
use super::root::Scene;
use super::shape::Shape;
use std::path::{Component, Path, PathBuf};

impl Scene {
    /// Refuses paths of the scene file that lead out of its folder: absolute ones, those that climb
    /// out by `..`, and those that a symbolic link leads out. What a `--set` argument names is taken
    /// for the user's own wish.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Invalid`] at the place of the path.
    pub fn check_paths(&self) -> Result<(), SceneError> {
        self.files().into_iter().filter(|path| path.place.source == 0).try_for_each(|path| {
            let folder = self.folder();
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            match reaches_out(folder, path) {
                Some(how) => Err(self.leads_out(path.place, path, how)),
                None => Ok(()),
            }
        })
    }

    /// The files that the scene names.
    fn files(&self) -> Vec<&At<PathBuf>> {
        let mut files = Vec::new();
        for solid in &self.solid {
            collect(&solid.shapes(), &mut files);
        }
        for region in self.fluid.values().flat_map(|fluid| fluid.regions.iter()) {
            collect(&region.shapes(), &mut files);
        }
        files
    }

    fn leads_out(&self, place: Place, path: &Path, how: &str) -> SceneError {
        let what =
            format!("the path {} leads out of the folder of the scene: {how}", path.display());
        let help =
            "move the file beside the scene, or run with --allow-paths if you trust the scene"
                .to_owned();
        self.error(place, ErrorKind::Invalid { what, help })
    }
}

fn collect<'a>(shapes: &[Shape<'a>], files: &mut Vec<&'a At<PathBuf>>) {
    for shape in shapes {
        match shape {
            Shape::Mesh(path) => files.push(path),
            Shape::Union(parts) | Shape::Difference(parts) => {
                parts.iter().for_each(|part| collect(&part.shapes(), files));
            }
            _ => {}
        }
    }
}

/// How a path leads out of a folder, if it does.
fn reaches_out(folder: &Path, path: &Path) -> Option<&'static str> {
    let mut depth = 0_usize;
    for part in path.components() {
        match part {
            Component::Prefix(_) | Component::RootDir => return Some("it is absolute"),
            Component::CurDir => {}
            Component::ParentDir => match depth.checked_sub(1) {
                Some(less) => depth = less,
                None => return Some("it climbs out by `..`"),
            },
            Component::Normal(_) => depth += 1,
        }
    }
    // Whether the file is there is found out by who reads it.
    let (folder, file) = (folder.canonicalize().ok()?, folder.join(path).canonicalize().ok()?);
    (!file.starts_with(folder)).then_some("a symbolic link points there")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(folder: &Path, solid: &str, overrides: &[&str]) -> Scene {
        let text = format!(
            "dimension = 3\nend_time = 1\n[numerics]\nspacing = 0.1\n[fluid.water]\ndensity = 1000\n\
             regions = [{{ box = {{ min = [0, 0, 0], max = [1, 1, 1] }} }}]\n[[solid]]\n\
             name = \"body\"\nfluid_side = \"outside\"\n{solid}\n"
        );
        let path = folder.join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        Scene::read(&path, &overrides).unwrap()
    }

    #[test]
    fn paths_stay_in_the_folder_of_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        for inside in ["body.stl", "sub/body.stl", "./sub/../body.stl", "no/../sub/a.stl"] {
            scene(folder.path(), &format!("mesh = \"{inside}\""), &[]).check_paths().unwrap();
        }
        for (outside, why) in [
            ("/etc/passwd", "absolute"),
            ("../body.stl", "climbs out"),
            ("sub/../../body.stl", "climbs out"),
        ] {
            for solid in [
                format!("mesh = \"{outside}\""),
                format!(
                    "union = [{{ difference = [{{ mesh = \"{outside}\" }}, \
                         {{ sphere = {{ center = [0, 0, 0], radius = 1 }} }}] }}]"
                ),
            ] {
                let error = scene(folder.path(), &solid, &[]).check_paths().unwrap_err();
                assert!(error.to_string().contains(why), "{error}");
                assert_eq!(error.line_and_column().unwrap().0, 11);
            }
        }
    }

    #[test]
    fn the_user_may_name_any_file() {
        let folder = tempfile::tempdir().unwrap();
        let set = ["solid.0.mesh=/etc/body.stl"];
        scene(folder.path(), "mesh = \"../body.stl\"", &set).check_paths().unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_do_not_lead_out() {
        let folder = tempfile::tempdir().unwrap();
        let (inner, other) = (folder.path().join("inner"), folder.path().join("other.stl"));
        std::fs::create_dir(&inner).unwrap();
        std::fs::write(&other, "solid").unwrap();
        std::fs::write(inner.join("own.stl"), "solid").unwrap();
        std::os::unix::fs::symlink(&other, inner.join("out.stl")).unwrap();
        std::os::unix::fs::symlink(inner.join("own.stl"), inner.join("in.stl")).unwrap();
        scene(&inner, "mesh = \"in.stl\"", &[]).check_paths().unwrap();
        let error = scene(&inner, "mesh = \"out.stl\"", &[]).check_paths().unwrap_err();
        assert!(error.to_string().contains("symbolic link"), "{error}");
    }
}
