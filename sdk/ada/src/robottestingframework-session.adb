--  SPDX-License-Identifier: Apache-2.0

with Ada.Strings.Unbounded; use Ada.Strings.Unbounded;
with Interfaces.C;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Asserter;
with RobotTestingFramework.Clock;
with RobotTestingFramework.Host;
with RobotTestingFramework.Process;
with System;

package body RobotTestingFramework.Session is

   use type Interfaces.C.int;
   use type Interfaces.C.size_t;
   use type Interfaces.Integer_32;
   use type Interfaces.Unsigned_32;

   Poll : constant Duration := 0.01;

   --  The host's table, if its minor version has this feature.
   function Table_Since
     (Minor : Interfaces.Unsigned_32; Feature : String) return not null ABI.Host_Access
   is (if Host.Table.Minor >= Minor then Host.Table
       else raise Program_Error with "this rtf is too old for " & Feature);

   function Told (Tell : not null ABI.Tell_Text) return String is
     (Host.To_Ada (Tell (Host.Table.Context)));

   function Name return String is (Told (Host.Table.Name));

   function Parameters return String is (Told (Host.Table.Param));

   function Listed
     (List : not null ABI.Tell_Parameters; Context : ABI.Address) return Cases.Named_Values
   is
      Count : aliased Interfaces.C.size_t := 0;
      First : constant ABI.Address        := List (Context, Count'Access);
      Found : array (1 .. Natural (Count)) of ABI.Parameter with Import, Address => First;
   begin
      return Values : Cases.Named_Values (1 .. Natural (Count)) do
         for Index in Values'Range loop
            Values (Index) := Cases.Named
              (Host.To_Ada (Found (Index).Name), Host.To_Ada (Found (Index).Value));
         end loop;
      end return;
   end Listed;

   --  The error for an unknown name: there is no <What> "..."; <Known_Are> a, b.
   function Find
     (Values          : Cases.Named_Values;
      Name            : String;
      What, Known_Are : String;
      File            : String;
      Line            : Natural) return String
   is
      Known : Unbounded_String;
   begin
      for Value of Values loop
         if Value.Name = Name then
            return To_String (Value.Value);
         end if;
         Append (Known, (if Length (Known) = 0 then "" else ", ") & Value.Name);
      end loop;
      Asserter.Error
        ("there is no " & What & " """ & Name & """; " & Known_Are & " "
         & (if Values'Length = 0 then "none" else To_String (Known)), File, Line);
   end Find;

   function Parameter_Values
     (File : String := Source.File; Line : Natural := Source.Line)
      return Cases.Named_Values
   is
      Table : constant not null ABI.Host_Access := Host.Table_Since_1_3 ("cases", File, Line);
   begin
      return Listed (Table.Parameters, Table.Context);
   end Parameter_Values;

   function Parameter
     (Name : String; File : String := Source.File; Line : Natural := Source.Line)
      return String
   is (Find (Parameter_Values (File, Line), Name, "parameter", "this test has", File, Line));

   function Fixture_Value
     (Name : String; File : String := Source.File; Line : Natural := Source.Line)
      return String
   is
      Table : constant not null ABI.Host_Access :=
        Host.Table_Since_1_3 ("values of fixtures", File, Line);
   begin
      return Find
        (Listed (Table.Values, Table.Context), Name, "fixture value", "there are", File, Line);
   end Fixture_Value;

   function Environment return String is (Told (Host.Table.Environment));

   function Argument_Count return Natural is (Process.Argument_Count);

   function Argument (Number : Positive) return String is (Process.Argument (Number));

   function Repetition return Positive is
     (Positive (Host.Table.Repetition (Host.Table.Context)));

   function Interrupted return Boolean is
     (Host.Table.Interrupted (Host.Table.Context) /= 0);

   function Current_Time return Duration is (Clock.Now);

   --  Sleeps by the wall clock.
   procedure Pause (Time : Duration) is
      Seconds : constant Interfaces.C.double := Interfaces.C.double (Time);
   begin
      if Host.Table.Wait (Host.Table.Context, Seconds) /= 0 then
         raise Stop_Requested;
      end if;
   end Pause;

   procedure Sleep (Time : Duration) is
      Watch  : Clock.Stopwatch;
      Passed : Duration := 0.0;
   begin
      if not Clock.Is_Simulated then
         Pause (Time);
         return;
      end if;
      Watch := Clock.Started;
      loop
         Pause (Duration'Min (Poll, Time - Passed));
         Clock.Read (Watch, Passed);
         exit when Passed >= Time;
      end loop;
   end Sleep;

   procedure Wait_Until
     (Timeout : Duration;
      What    : String;
      File    : String  := Source.File;
      Line    : Natural := Source.Line)
   is
      Watch  : Clock.Stopwatch := Clock.Started;
      Passed : Duration;
      Left   : Duration;
   begin
      while not Condition loop
         Clock.Read (Watch, Passed);
         Left := Timeout - Passed;
         if Left <= 0.0 then
            Asserter.Fail
              (What & ": not within " & Host.Image (Long_Float (Timeout))
               & " s" & (if Clock.Is_Simulated then " of simulated time" else "")
               & " (last value: false)", File, Line);
         end if;
         Pause (Duration'Min (Poll, Left));
      end loop;
   end Wait_Until;

   procedure Measure
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line)
   is
      Table        : constant not null ABI.Host_Access := Host.Table;
      Name_Text    : aliased constant String := Name;
      Unit_Text    : aliased constant String := Unit;
      Lowest       : aliased constant Long_Float := Low;
      Highest      : aliased constant Long_Float := High;
      Source_Text  : aliased constant String := File & ASCII.NUL;
      Within       : constant Interfaces.C.int := Table.Measure
        (Table.Context,
         (Size  => ABI.Measurement'Size / System.Storage_Unit,
          Name  => Host.To_C (Name_Text),
          Value => Interfaces.C.double (Value),
          Unit  => Host.To_C (Unit_Text),
          Low   => (if Low = No_Low then System.Null_Address else Lowest'Address),
          High  => (if High = No_High then System.Null_Address else Highest'Address),
          File  => Source_Text'Address,
          Line  => Interfaces.Unsigned_32 (Line)));
      pragma Unreferenced (Within);
   begin
      if Low /= Low or else High /= High then
         raise Constraint_Error with "a limit of `" & Name & "` is not a number";
      end if;
   end Measure;

   --  Not shared with Measure: the records differ, and their copies must outlive the call.
   procedure Sample
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      Time      : Long_Float := Now;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line)
   is
      Table        : constant not null ABI.Host_Access := Table_Since (2, "samples");
      Name_Text    : aliased constant String := Name;
      Unit_Text    : aliased constant String := Unit;
      Lowest       : aliased constant Long_Float := Low;
      Highest      : aliased constant Long_Float := High;
      Taken        : aliased constant Long_Float := Time;
      Source_Text  : aliased constant String := File & ASCII.NUL;
      Within       : Interfaces.C.int;
      pragma Unreferenced (Within);
   begin
      if Low /= Low or else High /= High then
         raise Constraint_Error with "a limit of `" & Name & "` is not a number";
      elsif not Time'Valid then
         raise Constraint_Error with "the time of a sample of `" & Name & "` is not finite";
      end if;
      Within := Table.Sample
        (Table.Context,
         (Size  => ABI.Sample'Size / System.Storage_Unit,
          Name  => Host.To_C (Name_Text),
          Value => Interfaces.C.double (Value),
          Unit  => Host.To_C (Unit_Text),
          Low   => (if Low = No_Low then System.Null_Address else Lowest'Address),
          High  => (if High = No_High then System.Null_Address else Highest'Address),
          Time  => (if Time = Now then System.Null_Address else Taken'Address),
          File  => Source_Text'Address,
          Line  => Interfaces.Unsigned_32 (Line)));
   end Sample;

   procedure Check_Trajectory
     (Name      : String;
      Reference : String;
      Tolerance : Long_Float;
      Align     : Alignment  := By_Time;
      Band      : Long_Float := Default_Band;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line)
   is
      Table          : constant not null ABI.Host_Access := Table_Since (4, "trajectories");
      Name_Text      : aliased constant String := Name;
      Reference_Text : aliased constant String := Reference;
      Given_Band     : aliased constant Long_Float := Band;
      Source_Text    : aliased constant String := File & ASCII.NUL;
   begin
      Table.Trajectory
        (Table.Context,
         (Size      => ABI.Trajectory'Size / System.Storage_Unit,
          Name      => Host.To_C (Name_Text),
          Reference => Host.To_C (Reference_Text),
          Tolerance => Interfaces.C.double (Tolerance),
          Band      =>
            (if Band = Default_Band then System.Null_Address else Given_Band'Address),
          File      => Source_Text'Address,
          Line      => Interfaces.Unsigned_32 (Line),
          Align     => Alignment'Pos (Align)));
   end Check_Trajectory;

   procedure Check_Picture
     (Name      : String;
      Picture   : String;
      Reference : String;
      Tolerance : Long_Float;
      File      : String  := Source.File;
      Line      : Natural := Source.Line)
   is
      Table          : constant not null ABI.Host_Access := Host.Table;
      Name_Text      : aliased constant String := Name;
      Picture_Text   : aliased constant String := Picture;
      Reference_Text : aliased constant String := Reference;
      Source_Text    : aliased constant String := File & ASCII.NUL;
   begin
      if Table.Size < ABI.Host_Table'Size / System.Storage_Unit then
         raise Program_Error with "this rtf is too old for pictures";
      end if;
      Table.Picture
        (Table.Context,
         (Size      => ABI.Picture'Size / System.Storage_Unit,
          Name      => Host.To_C (Name_Text),
          Picture   => Host.To_C (Picture_Text),
          Reference => Host.To_C (Reference_Text),
          Tolerance => Interfaces.C.double (Tolerance),
          File      => Source_Text'Address,
          Line      => Interfaces.Unsigned_32 (Line)));
   end Check_Picture;

   procedure Monitor
     (Formula : String;
      Name    : String   := "";
      Meaning : Severity := Fail;
      File    : String   := Source.File;
      Line    : Natural  := Source.Line)
   is
      Table         : constant not null ABI.Host_Access := Table_Since (4, "monitors");
      Formula_Text  : aliased constant String := Formula;
      Name_Text     : aliased constant String := Name;
      Severity_Text : aliased constant String :=
        (case Meaning is
           when Fail     => "fail",
           when Error    => "error",
           when Stop     => "stop",
           when Critical => "critical");
      Source_Text   : aliased constant String := File & ASCII.NUL;
   begin
      Table.Monitor
        (Table.Context,
         (Size     => ABI.Monitor'Size / System.Storage_Unit,
          Formula  => Host.To_C (Formula_Text),
          Name     => Host.To_C (Name_Text),
          Severity => Host.To_C (Severity_Text),
          File     => Source_Text'Address,
          Line     => Interfaces.Unsigned_32 (Line)));
   end Monitor;

   procedure Sample_For
     (Name      : String;
      Time      : Duration;
      Rate      : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line)
   is
      Watch  : Clock.Stopwatch := Clock.Started;
      Passed : Duration := 0.0;
      Tick   : Long_Float := 0.0;
   begin
      if not (Rate > 0.0) then
         raise Constraint_Error with "the rate of `" & Name & "` is not above 0 Hz";
      end if;
      --  Each tick has a separate deadline, so that delays do not accumulate.
      while Tick < Long_Float (Time) * Rate - 1.0E-9 loop
         Sleep (Duration (Tick / Rate) - Passed);
         Sample (Name, Read, Unit, Low, High, Now, File, Line);
         Clock.Read (Watch, Passed);
         Tick := Long_Float'Max (Tick + 1.0, Long_Float'Ceiling (Long_Float (Passed) * Rate));
      end loop;
      Sleep (Time - Passed);
   end Sample_For;

   function Ask
     (Question : String;
      Choices  : Cases.Case_Names := No_Choices;
      Timeout  : Duration         := Answer_Time;
      Default  : String           := "";
      Picture  : String           := "";
      File     : String           := Source.File;
      Line     : Natural          := Source.Line) return String
   is
      Table         : constant not null ABI.Host_Access :=
        Host.Table_Since_1_3 ("questions", File, Line);
      Question_Text : aliased constant String := Question;
      Default_Text  : aliased constant String := Default;
      Picture_Text  : aliased constant String := Picture;
      Source_Text   : aliased constant String := File & ASCII.NUL;
      Given         : aliased ABI.Text;
      All_Choices   : Unbounded_String;
   begin
      for Choice of Choices loop
         Append (All_Choices, Choice);
      end loop;
      declare
         Content : aliased constant String := To_String (All_Choices);
         Next    : Positive                := 1;
         Texts   : array (Choices'Range) of aliased ABI.Text;
      begin
         for Index in Choices'Range loop
            Host.Lend (Content, Next, Length (Choices (Index)), Texts (Index));
         end loop;
         if Table.Ask
           (Table.Context,
            (Size           => ABI.Question'Size / System.Storage_Unit,
             Content        => Host.To_C (Question_Text),
             Choices        => Texts'Address,
             Choice_Count   => Texts'Length,
             Default_Answer => Host.To_C (Default_Text),
             Timeout        => Interfaces.C.double (Timeout),
             Picture        => Host.To_C (Picture_Text),
             File           => Source_Text'Address,
             Line           => Interfaces.Unsigned_32 (Line)),
            Given'Access) = ABI.Done
         then
            return Host.To_Ada (Given);
         elsif Interrupted then
            raise Stop_Requested;
         else
            --  The host has reported the error.
            raise Assertion_Ended with "no answer to """ & Question & """";
         end if;
      end;
   end Ask;

   procedure Instruct
     (Text    : String;
      Picture : String   := "";
      Timeout : Duration := Answer_Time;
      Default : String   := "";
      File    : String   := Source.File;
      Line    : Natural  := Source.Line)
   is
      Answers : constant Cases.Case_Names := (Cases."+" ("done"), Cases."+" ("cannot"));
   begin
      if Ask (Text, Answers, Timeout, Default, Picture, File, Line) /= "done" then
         Asserter.Error ("the operator cannot do this: " & Text, File, Line);
      end if;
   end Instruct;

   procedure Attach (Path : String; Name : String := ""; Media_Type : String := "") is
      Table      : constant not null ABI.Host_Access := Host.Table;
      Path_Text  : aliased constant String := Path;
      Name_Text  : aliased constant String := Name;
      Type_Text  : aliased constant String := Media_Type;
   begin
      Table.Attach
        (Table.Context,
         (Size       => ABI.Attachment'Size / System.Storage_Unit,
          Path       => Host.To_C (Path_Text),
          Name       => Host.To_C (Name_Text),
          Media_Type => Host.To_C (Type_Text)));
   end Attach;

end RobotTestingFramework.Session;
