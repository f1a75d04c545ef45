--  SPDX-License-Identifier: Apache-2.0

with RobotTestingFramework.ABI;
with RobotTestingFramework.Host;
with RobotTestingFramework.Near;

package body RobotTestingFramework.Asserter is

   procedure Report
     (Message : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Host.Send (ABI.Report, Message, File, Line);
   end Report;

   procedure Check
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      Host.Send ((if Condition then ABI.Check else ABI.Failure), Message, File, Line);
   end Check;

   procedure Require
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      Check (Condition, Message, File, Line);
      if not Condition then
         raise Assertion_Ended with Message;
      end if;
   end Require;

   procedure Require_Critical
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      if Condition then
         Host.Send (ABI.Check, Message, File, Line);
      else
         Host.Send (ABI.Failure, Message, File, Line, Critical => True);
         raise Assertion_Ended with Message;
      end if;
   end Require_Critical;

   procedure Fail
     (Message : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Host.Send (ABI.Failure, Message, File, Line);
      raise Assertion_Ended with Message;
   end Fail;

   procedure Error
     (Message : String; File : String := Source.File; Line : Natural := Source.Line) is
   begin
      Host.Send (ABI.Error, Message, File, Line);
      raise Assertion_Ended with Message;
   end Error;

   --  Tells how near they are; an assertion ends the step.
   procedure Compare
     (Numbers_Are : Near.Comparison;
      What        : String;
      File        : String;
      Line        : Natural;
      Assert      : Boolean)
   is
      Holds : Boolean;
   begin
      Near.Tell (Numbers_Are, What, File, Line, Holds);
      if Assert and then not Holds then
         raise Assertion_Ended with What;
      end if;
   end Compare;

   --  One number is a vector of one, which is told apart in the message.
   function Scalar
     (Got, Expected, Tolerance : Long_Float; Angle : Boolean) return Near.Comparison is
     ((Count          => 1,
       Expected_Count => 1,
       Got            => (1 => Got),
       Expected       => (1 => Expected),
       Tolerance      => Tolerance,
       Angle          => Angle,
       Scalar         => True));

   function Vector
     (Got, Expected : Numbers; Tolerance : Long_Float; Angle : Boolean) return Near.Comparison is
     ((Count          => Got'Length,
       Expected_Count => Expected'Length,
       Got            => Near.Numbers (Got),
       Expected       => Near.Numbers (Expected),
       Tolerance      => Tolerance,
       Angle          => Angle,
       Scalar         => False));

   procedure Check_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare (Scalar (Got, Expected, Tolerance, False), What, File, Line, Assert => False);
   end Check_Near;

   procedure Check_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Vector (Got, Expected, Tolerance, False), What, File, Line, Assert => False);
   end Check_Near;

   procedure Require_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare (Scalar (Got, Expected, Tolerance, False), What, File, Line, Assert => True);
   end Require_Near;

   procedure Require_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Vector (Got, Expected, Tolerance, False), What, File, Line, Assert => True);
   end Require_Near;

   procedure Check_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare (Scalar (Got, Expected, Tolerance, True), What, File, Line, Assert => False);
   end Check_Angle_Near;

   procedure Check_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Vector (Got, Expected, Tolerance, True), What, File, Line, Assert => False);
   end Check_Angle_Near;

   procedure Require_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare (Scalar (Got, Expected, Tolerance, True), What, File, Line, Assert => True);
   end Require_Angle_Near;

   procedure Require_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Vector (Got, Expected, Tolerance, True), What, File, Line, Assert => True);
   end Require_Angle_Near;

   procedure TestFailIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      if not Condition then
         Host.Send (ABI.Failure, Message, File, Line);
      end if;
   end TestFailIf;

   procedure FailIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      if not Condition then
         Fail (Message, File, Line);
      end if;
   end FailIf;

   procedure ErrorIf
     (Condition : Boolean;
      Message   : String;
      File      : String  := Source.File;
      Line      : Natural := Source.Line) is
   begin
      if not Condition then
         Error (Message, File, Line);
      end if;
   end ErrorIf;

end RobotTestingFramework.Asserter;
