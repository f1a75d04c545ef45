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
         raise Critical_Assertion_Ended with Message;
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

   procedure Skip
     (Reason : String; File : String := Source.File; Line : Natural := Source.Line)
   is
      Table : constant not null ABI.Host_Access := Host.Table_Since_1_3 ("cases", File, Line);
      Text  : aliased constant String           := Reason;
   begin
      Table.Skip (Table.Context, Host.To_C (Text));
      raise Assertion_Ended with Reason;
   end Skip;

   --  Reports the comparison; a failed assertion ends the step.
   procedure Compare
     (Got, Expected         : Numbers;
      Tolerance             : Long_Float;
      What, File            : String;
      Line                  : Natural;
      Scalar, Angle, Assert : Boolean := False)
   is
      Holds : Boolean;
   begin
      Near.Report
        ((Count          => Got'Length,
          Expected_Count => Expected'Length,
          Got            => Near.Numbers (Got),
          Expected       => Near.Numbers (Expected),
          Tolerance      => Tolerance,
          Angle          => Angle,
          Scalar         => Scalar), What, File, Line, Holds);
      if Assert and then not Holds then
         raise Assertion_Ended with What;
      end if;
   end Compare;

   --  Ada requires each profile again, also in a renaming of a generic instance, which would be
   --  as long as these bodies.

   procedure Check_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare ((1 => Got), (1 => Expected), Tolerance, What, File, Line, Scalar => True);
   end Check_Near;

   procedure Check_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Got, Expected, Tolerance, What, File, Line);
   end Check_Near;

   procedure Require_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare
        ((1 => Got), (1 => Expected), Tolerance, What, File, Line,
         Scalar => True, Assert => True);
   end Require_Near;

   procedure Require_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Got, Expected, Tolerance, What, File, Line, Assert => True);
   end Require_Near;

   procedure Check_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare
        ((1 => Got), (1 => Expected), Tolerance, What, File, Line,
         Scalar => True, Angle => True);
   end Check_Angle_Near;

   procedure Check_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Got, Expected, Tolerance, What, File, Line, Angle => True);
   end Check_Angle_Near;

   procedure Require_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) is
   begin
      Compare
        ((1 => Got), (1 => Expected), Tolerance, What, File, Line,
         Scalar => True, Angle => True, Assert => True);
   end Require_Angle_Near;

   procedure Require_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) is
   begin
      Compare (Got, Expected, Tolerance, What, File, Line, Angle => True, Assert => True);
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
