--  SPDX-License-Identifier: Apache-2.0
--  The plug-in's arguments and the process's clock.

with Interfaces.C;
with System;

private package RobotTestingFramework.Process is

   --  Keeps arguments as main() gets them: the first is the plug-in's name.
   procedure Keep (Count : Interfaces.C.int; Arguments : System.Address);

   --  The arguments after the name, counted from 1.
   function Argument_Count return Natural;
   function Argument (Number : Positive) return String;

   --  A clock that nobody sets. Ada.Real_Time would bring the tasking runtime
   --  into each plug-in.
   function Monotonic return Duration;

end RobotTestingFramework.Process;
