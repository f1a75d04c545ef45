with Ada.Strings.Fixed;
with GNAT.Expect;
with GNAT.OS_Lib; use GNAT.OS_Lib;
with Interfaces.C; use Interfaces.C;

with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Children is

   function Fork return int with Import, Convention => C, External_Name => "fork";

   function Wait_For (Child : int; Status : out int; Options : int) return int
     with Import, Convention => C, External_Name => "waitpid";

   function System (Command : char_array) return int
     with Import, Convention => C, External_Name => "system";

   --  The code that a shell returns for a process.
   function Ended (Status : int) return Integer is
     (Integer (if Status mod 128 = 0 then Status / 256 else 128 + Status mod 128));

   function Shell return Argument_List is (new String'("-c"), new String'("exit 3"));

   --  Executes the program of this process again, with its arguments.
   function Start_Itself return Integer is
      File   : constant File_Descriptor := Open_Read ("/proc/self/cmdline", Binary);
      Text   : String (1 .. 10_000);
      Last   : constant Natural := Read (File, Text'Address, Text'Length);
      Words  : Argument_List (1 .. 100);
      Count  : Natural := 0;
      Start  : Positive := Ada.Strings.Fixed.Index (Text, (1 => ASCII.NUL)) + 1;
      Finish : Natural;
   begin
      Close (File);
      while Start <= Last loop
         Finish := Ada.Strings.Fixed.Index (Text, (1 => ASCII.NUL), Start);
         Count := Count + 1;
         Words (Count) := new String'(Text (Start .. Finish - 1));
         Start := Finish + 1;
      end loop;
      return Spawn ("/proc/self/exe", Words (1 .. Count));
   end Start_Itself;

   function Start_And_Wait return Integer is
      Child, Found : Process_Id;
      Succeeded    : Boolean;
   begin
      Child := Non_Blocking_Spawn ("/bin/true", (1 .. 0 => null));
      Wait_Process (Found, Succeeded);
      return (if Found = Child and then Succeeded then 0 else 1);
   end Start_And_Wait;

   function Start_With_Pipes return Integer is
      Status : aliased Integer;
      Output : constant String :=
        GNAT.Expect.Get_Command_Output ("/bin/sh", Shell, "", Status'Access);
   begin
      return (if Output = "" then Status else 1);
   end Start_With_Pipes;

   overriding procedure Run (Self : in out Test) is
      pragma Unreferenced (Self);
      How    : constant String := Argument (2);
      Child  : int;
      Status : int;
      Code   : Integer;
   begin
      if How = "itself" then
         Code := Start_Itself;
      elsif How = "spawn" then
         Code := Spawn ("/bin/sh", Shell);
      elsif How = "non-blocking" then
         Code := Start_And_Wait;
      elsif How = "expect" then
         Code := Start_With_Pipes;
      elsif How = "system" then
         Code := Ended (System (To_C ("exit 3")));
      else
         Child := Fork;
         if Child = 0 then
            if How = "exit" then
               OS_Exit (3);
            elsif How = "abort" then
               OS_Abort;
            end if;
            return;
         end if;
         Child := Wait_For (Child, Status, 0);
         Code := Ended (Status);
      end if;
      Report ("ended" & Code'Image);
      Check (Argument_Count = 2, "it was asked to fail");
   end Run;

end Children;
