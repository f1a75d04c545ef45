--  SPDX-License-Identifier: Apache-2.0
--  Reports exceptions that end a step or a case.

with Ada.Exceptions;

private package RobotTestingFramework.Exceptions is

   --  Reports an exception as an error: its name, its text, and the call addresses, if
   --  the binder stores them (switch -E).
   procedure Report (Raised : Ada.Exceptions.Exception_Occurrence);

end RobotTestingFramework.Exceptions;
