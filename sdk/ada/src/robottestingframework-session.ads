--  SPDX-License-Identifier: Apache-2.0
--  What the suite says of the plug-in, waiting that ends when the runner asks to
--  stop, and what is kept with the result.

with GNAT.Source_Info;

package RobotTestingFramework.Session is

   package Source renames GNAT.Source_Info;

   --  The name under which the suite knows this plug-in.
   function Name return String;

   --  The parameter string as it stands in the suite, and the words in it.
   function Parameters return String;
   function Argument_Count return Natural;
   function Argument (Number : Positive) return String;

   --  The suite's environment string.
   function Environment return String;

   --  The repetition that runs, from 1.
   function Repetition return Positive;

   --  Whether the runner has asked to stop; a loop that runs long should look.
   function Interrupted return Boolean;

   --  The time since a moment that does not matter, by the clock that the suite has.
   function Current_Time return Duration;

   --  Sleeps, in a suite with a clock by that one, but wakes at once when the
   --  runner asks to stop; then this step ends.
   procedure Sleep (Time : Duration);

   --  Waits until the condition is true, asking every 10 ms. When the time is
   --  over this is a failed assertion, which tells what was waited for.
   generic
      with function Condition return Boolean;
   procedure Wait_Until
     (Timeout : Duration;
      What    : String;
      File    : String  := Source.File;
      Line    : Natural := Source.Line);

   --  Limits that do not limit.
   No_Low  : constant Long_Float := Long_Float'First;
   No_High : constant Long_Float := Long_Float'Last;

   --  Keeps a number with the result; outside its limits it is a failure, and so
   --  is a value that is not a finite number.
   procedure Measure
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  The present time, where the time of a sample is asked for.
   Now : constant Long_Float := Long_Float'First;

   --  Takes a sample of a signal, in a test; outside its limits it is a failure, and
   --  so is a value that is not a finite number. The time counts in seconds from
   --  the beginning of the set-up.
   procedure Sample
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      Time      : Long_Float := Now;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  Samples what Read returns, so many times a second. What a reading that takes
   --  too long misses is left out.
   generic
      with function Read return Long_Float;
   procedure Sample_For
     (Name      : String;
      Time      : Duration;
      Rate      : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  Keeps a file with the result. It is copied now: write it before, to its
   --  end. Without a name it is shown under its own.
   procedure Attach (Path : String; Name : String := ""; Media_Type : String := "");

end RobotTestingFramework.Session;
