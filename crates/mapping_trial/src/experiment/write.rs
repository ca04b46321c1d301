//! Files that appear whole or not at all.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use super::store::ExperimentError;

/// Makes a folder, and says whether files can be written into it.
pub(super) fn folder(path: &Path) -> Result<(), ExperimentError> {
    let error = |source| ExperimentError::File { path: path.to_owned(), source };
    fs::create_dir_all(path).map_err(error)?;
    // A file that cannot be made is told without its random name.
    NamedTempFile::new_in(path).map(drop).map_err(|source| error(source.kind().into()))
}

/// Writes a file under another name first.
pub(super) fn whole(path: &Path, bytes: &[u8]) -> Result<(), ExperimentError> {
    let error = |source| ExperimentError::File { path: path.to_owned(), source };
    let folder = path.parent().unwrap_or(Path::new("."));
    let temporary = readable().tempfile_in(folder);
    let mut out = BufWriter::new(temporary.map_err(|source| error(source.kind().into()))?);
    out.write_all(bytes).map_err(error)?;
    let file = out.into_inner().map_err(|failed| error(failed.into_error()))?;
    file.persist(path).map(drop).map_err(|failed| error(failed.error))
}

/// Files that others may read, as far as the user's mask allows, as other files are.
fn readable() -> Builder<'static, 'static> {
    #[cfg_attr(not(unix), expect(unused_mut, reason = "files have no mode there"))]
    let mut builder = Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
}
