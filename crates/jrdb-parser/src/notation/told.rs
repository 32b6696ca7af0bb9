//! Reads universals and commands.

use jrdb_types::query::{Command, Share, Task};

use super::cursor::{Read, Reader};

impl Reader<'_> {
    /// `all [sitting] of`.
    pub(super) fn each(&mut self) -> Read<Task> {
        let share = match () {
            () if self.takes("all") => Share::All,
            () if self.takes("none") => Share::None,
            () if self.takes("most") => Share::Most,
            () if self.takes("half") => Share::Half,
            () => return Err(self.wanted("all, none, most or half")),
        };
        self.expect("[")?;
        let asked = self.conditions("]")?;
        self.expect("of")?;
        Ok(Task::Each { share, asked })
    }

    /// `"take" "this" to "the kitchen"`.
    pub(super) fn command(&mut self) -> Read<Command> {
        let verb = self.quoted().ok_or_else(|| self.wanted("a quoted verb"))?;
        let object = self.quoted();
        let destination = if self.takes("to") {
            Some(self.quoted().ok_or_else(|| self.wanted("a quoted place"))?)
        } else {
            None
        };
        Ok(Command { verb, object, destination })
    }
}
