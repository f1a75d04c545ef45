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
     (Numbers_Are : Near.Comparison;
      What        : String;
      File        : String;
      Line        : Natural;
      Assert      : Boolean)
   is
      Holds : Boolean;
   begin
      Near.Report (Numbers_Are, What, File, Line, Holds);
      if Assert and then not Holds then
         raise Assertion_Ended with What;
      end if;
   end Compare;

   generic
      Angle, Assert : Boolean;
   procedure Compare_Numbers
     (Got, Expected, Tolerance : Long_Float; What, File : String; Line : Natural);

   procedure Compare_Numbers
     (Got, Expected, Tolerance : Long_Float; What, File : String; Line : Natural) is
   begin
      Compare
        ((Count          => 1,
          Expected_Count => 1,
          Got            => (1 => Got),
          Expected       => (1 => Expected),
          Tolerance      => Tolerance,
          Angle          => Angle,
          Scalar         => True), What, File, Line, Assert);
   end Compare_Numbers;

   generic
      Angle, Assert : Boolean;
   procedure Compare_Vectors
     (Got, Expected : Numbers; Tolerance : Long_Float; What, File : String; Line : Natural);

   procedure Compare_Vectors
     (Got, Expected : Numbers; Tolerance : Long_Float; What, File : String; Line : Natural) is
   begin
      Compare
        ((Count          => Got'Length,
          Expected_Count => Expected'Length,
          Got            => Near.Numbers (Got),
          Expected       => Near.Numbers (Expected),
          Tolerance      => Tolerance,
          Angle          => Angle,
          Scalar         => False), What, File, Line, Assert);
   end Compare_Vectors;

   procedure Check_Numbers is new Compare_Numbers (Angle => False, Assert => False);
   procedure Require_Numbers is new Compare_Numbers (Angle => False, Assert => True);
   procedure Check_Angles is new Compare_Numbers (Angle => True, Assert => False);
   procedure Require_Angles is new Compare_Numbers (Angle => True, Assert => True);
   procedure Check_Vectors is new Compare_Vectors (Angle => False, Assert => False);
   procedure Require_Vectors is new Compare_Vectors (Angle => False, Assert => True);
   procedure Check_Angle_Vectors is new Compare_Vectors (Angle => True, Assert => False);
   procedure Require_Angle_Vectors is new Compare_Vectors (Angle => True, Assert => True);

   procedure Check_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) renames Check_Numbers;
   procedure Check_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) renames Check_Vectors;

   procedure Require_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) renames Require_Numbers;
   procedure Require_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) renames Require_Vectors;

   procedure Check_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) renames Check_Angles;
   procedure Check_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) renames Check_Angle_Vectors;

   procedure Require_Angle_Near
     (Got, Expected, Tolerance : Long_Float;
      What                     : String;
      File                     : String  := Source.File;
      Line                     : Natural := Source.Line) renames Require_Angles;
   procedure Require_Angle_Near
     (Got, Expected : Numbers;
      Tolerance     : Long_Float;
      What          : String;
      File          : String  := Source.File;
      Line          : Natural := Source.Line) renames Require_Angle_Vectors;

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
