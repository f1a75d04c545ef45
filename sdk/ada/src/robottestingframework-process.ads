--  SPDX-License-Identifier: Apache-2.0
--  The plug-in's arguments and the process's clock.

with Interfaces.C;
with System;

private package RobotTestingFramework.Process is

   --  Stores arguments like those of main(): the first is the plug-in's name.
   procedure Set_Arguments (Count : Interfaces.C.int; Arguments : System.Address);

   --  The arguments after the name, counted from 1.
   function Argument_Count return Natural;
   function Argument (Number : Positive) return String;

   --  A monotonic clock. Ada.Real_Time would add the tasking runtime to each plug-in.
   function Monotonic return Duration;

end RobotTestingFramework.Process;
