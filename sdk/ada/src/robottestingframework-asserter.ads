--  SPDX-License-Identifier: Apache-2.0
--  Checks and assertions. The location in a message is the caller's.
--
--  All may be called from any task. Those that end a step or a case raise an exception, and
--  must be called in the task that runs it.

with GNAT.Source_Info;

package RobotTestingFramework.Asserter is

   package Source renames GNAT.Source_Info;

   --  Reports information; it does not change the verdict.
   procedure Report
     (Message : String; File : String := Source.File; Line : Natural := Source.Line);

   --  Checks that the condition holds, and continues in either case.
   procedure Check
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);

   --  Asserts that the condition holds; if it does not, this step ends.
   procedure Require
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);

   --  Asserts that it is safe to continue: if not, the rest of the suite is skipped.
   procedure Require_Critical
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);

   --  Reports a failure (the robot is wrong) and ends this step.
   procedure Fail
     (Message : String; File : String := Source.File; Line : Natural := Source.Line)
     with No_Return;

   --  Reports an error (the bench is wrong) and ends this step.
   procedure Error
     (Message : String; File : String := Source.File; Line : Natural := Source.Line)
     with No_Return;

   --  Ends the innermost case of this task, or without one the test, as skipped: the bench
   --  lacks something. Allowed in Setup and Run.
   procedure Skip
     (Reason : String; File : String := Source.File; Line : Natural := Source.Line)
     with No_Return;

   type Numbers is array (Positive range <>) of Long_Float;

   --  Checks that two numbers, or two vectors, differ by at most Tolerance anywhere.
   procedure Check_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line);
   procedure Check_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line);

   --  The same as an assertion.
   procedure Require_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line);
   procedure Require_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line);

   --  Checks angles in radians: 3.1 and -3.1 are 0.083 apart.
   procedure Check_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line);
   procedure Check_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line);

   --  The same as an assertion.
   procedure Require_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line);
   procedure Require_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line);

   --  The predecessor's names. Despite their names, ErrorIf, FailIf and TestFailIf
   --  report an error or a failure *unless* the condition holds.
   procedure TestReport
     (Message : String; File : String := Source.File; Line : Natural := Source.Line)
     renames Report;
   procedure TestCheck
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line)
     renames Check;
   procedure TestFailIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);
   procedure FailIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);
   procedure ErrorIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);

end RobotTestingFramework.Asserter;
