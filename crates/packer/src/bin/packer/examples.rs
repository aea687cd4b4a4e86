//! Examples that stand under the help of the program and of each command.

pub(crate) const ALL: &str = "\
Examples:
  packer check bunny.obj
  packer pack bunny.obj -o bunny.ist
  packer pack bunny.obj -o bunny.ist --spheres 5000 --preview bunny.png
  packer batch meshes -o packings
  packer info bunny.ist --urdf bunny.urdf

Exit status: 0 if all went well, 2 for bad input or a file that could not be read or written.";

pub(crate) const PACK: &str = "\
Examples:
  packer pack bunny.obj -o bunny.ist
  packer pack bunny.obj -o bunny.ist --preset fine --preview bunny.png
  packer pack gear.stl -o gear.ist --spheres 100000 --coverage 0.8 --json
  packer pack arm.glb -o arm.ist -n 200 --urdf arm.urdf --density 2700";

pub(crate) const BATCH: &str = "\
meshes/sub/a.obj becomes packings/sub/a.obj.ist. Files and folders whose names begin with a dot are left out.
Run it again to go on after a stop or to pack what has changed.

Examples:
  packer batch meshes -o packings
  packer batch meshes -o packings --preset fine --json > report.json
  packer batch meshes -o packings --shard 3/8

In a Slurm array job with --array=1-8; docs/packing.md has the whole file, and one for Kubernetes:
  packer batch meshes -o packings --shard \"$SLURM_ARRAY_TASK_ID/8\"

Exit status: 0 if every mesh has its packing, 2 if any failed; all others are packed all the same.";

pub(crate) const CHECK: &str = "\
Examples:
  packer check bunny.obj
  packer check bunny.obj --json";

pub(crate) const INFO: &str = "\
Examples:
  packer info bunny.ist
  packer info bunny.ist --json
  packer info bunny.ist --csv bunny.csv --preview bunny.png
  packer info bunny.ist --urdf bunny.urdf --density 2700";

pub(crate) const COMPLETIONS: &str = "\
Examples:
  packer completions bash > ~/.local/share/bash-completion/completions/packer
  packer completions zsh > ~/.zfunc/_packer
  packer completions fish > ~/.config/fish/completions/packer.fish";
