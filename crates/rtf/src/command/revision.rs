//! The revision of the sources in a folder: what Git has checked out there. Git's
//! files are read, no program is started.

use std::path::{Path, PathBuf};

use rtf_model::Revision;

/// The longest chain of references that is followed.
const REFERENCES: usize = 5;

/// What is checked out in this folder, or in one above it.
pub fn of(folder: &Path) -> Option<Revision> {
    let git = folder.ancestors().find_map(|folder| git_folder(&folder.join(".git")))?;
    let head = first_line(&git.join("HEAD"))?;
    let Some(reference) = head.strip_prefix("ref: ") else {
        return commit(&head).map(|commit| Revision { commit, branch: None });
    };
    let branch = reference.strip_prefix("refs/heads/").map(str::to_owned);
    resolve(&git, reference).map(|commit| Revision { commit, branch })
}

/// The folder of a repository: itself, or where the file of a worktree leads.
fn git_folder(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        return Some(path.to_owned());
    }
    let link = first_line(path)?;
    Some(path.parent()?.join(link.strip_prefix("gitdir: ")?))
}

fn resolve(git: &Path, reference: &str) -> Option<String> {
    let common = first_line(&git.join("commondir"));
    let common = common.map_or_else(|| git.to_owned(), |common| git.join(common));
    let mut reference = reference.to_owned();
    for _ in 0..REFERENCES {
        let own = first_line(&git.join(&reference));
        let line = own.or_else(|| first_line(&common.join(&reference)));
        match line.as_deref().map(|line| (line, line.strip_prefix("ref: "))) {
            Some((_, Some(next))) => reference = next.to_owned(),
            Some((line, None)) => return commit(line),
            None => return packed(&common, &reference),
        }
    }
    None
}

fn packed(common: &Path, reference: &str) -> Option<String> {
    let text = std::fs::read_to_string(common.join("packed-refs")).ok()?;
    let mut lines = text.lines().filter_map(|line| line.split_once(' '));
    lines.find(|(_, name)| *name == reference).and_then(|(hash, _)| commit(hash))
}

fn commit(hash: &str) -> Option<String> {
    let is_hash = hash.len() >= 40 && hash.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hash.then(|| hash.to_owned())
}

fn first_line(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    text.lines().next().map(|line| line.trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HASH: &str = "0123456789abcdef0123456789abcdef01234567";

    #[test]
    fn a_branch_a_commit_a_packed_reference_and_a_worktree() {
        let temp = tempfile::tempdir().unwrap();
        let (top, deep) = (temp.path().join("top"), temp.path().join("top/a/b"));
        std::fs::create_dir_all(&deep).unwrap();
        assert_eq!(git_folder(&top.join(".git")), None);
        let write = |name: &str, text: &str| {
            let path = temp.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let found = |branch: Option<&str>| {
            let branch = branch.map(str::to_owned);
            Some(Revision { commit: HASH.to_owned(), branch })
        };
        write("top/.git/HEAD", &format!("{HASH}\n"));
        assert_eq!(of(&deep), found(None), "a commit alone");
        write("top/.git/HEAD", "ref: refs/heads/arm/new\n");
        assert_eq!(of(&deep), None, "a branch without a commit");
        write("top/.git/packed-refs", &format!("# pack-refs\n{HASH} refs/heads/arm/new\n"));
        assert_eq!(of(&deep), found(Some("arm/new")));
        write("top/.git/refs/heads/arm/new", &format!("{HASH}\n"));
        assert_eq!(of(&top), found(Some("arm/new")));
        write("tree/.git", "gitdir: ../top/.git/worktrees/tree\n");
        write("top/.git/worktrees/tree/HEAD", "ref: refs/heads/arm/new\n");
        write("top/.git/worktrees/tree/commondir", "../..\n");
        assert_eq!(of(&temp.path().join("tree")), found(Some("arm/new")));
    }
}
